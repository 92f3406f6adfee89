/* Clips triangles at the near plane, and at planes far beyond the picture's sides. In double precision. Pure. */
#ifndef SHEEN_RENDER_NATIVE_CLIP_CLIP_H
#define SHEEN_RENDER_NATIVE_CLIP_CLIP_H

#include "server/render/view.h"

/* A corner in camera space, with two numbers that are linear over the triangle. */
struct native_corner {
    double at[3], s, t;
};

/* There are five planes, and each adds at most one corner. */
enum { CLIP_PLANES = 5, CLIP_MOST_CORNERS = 3 + CLIP_PLANES };

/* The clip planes of a view: the near plane, and one beyond each side of the picture. */
struct native_clip {
    struct native_clip_plane {
        double normal[3], offset;
    } plane[CLIP_PLANES];
};

void native_clip_init(struct native_clip *clip, const struct view *view);
/* True if all that is at most `off` away from the hull of n points lies on the outer side of one plane. */
bool native_clip_excludes(const struct native_clip *clip, const struct native_corner *points, int n,
                          double off);
/* Clips a triangle to a convex polygon. Returns the number of its corners: 0, or 3 and more. */
int native_clip_triangle(const struct native_clip *clip, const struct native_corner triangle[3],
                         struct native_corner left[CLIP_MOST_CORNERS]);

#endif
