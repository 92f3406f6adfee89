/* Triangles that the near plane cuts, or that reach far beyond the picture: what is left of them there. In double. Pure. */
#ifndef SHEEN_RENDER_NATIVE_CLIP_H
#define SHEEN_RENDER_NATIVE_CLIP_H

#include "server/render/view.h"

/* A corner in camera space, and two numbers that are linear over the triangle. */
struct native_corner {
    double at[3], s, t;
};

/* Five planes cut, and each adds a corner at most. */
enum { CLIP_PLANES = 5, CLIP_MOST_CORNERS = 3 + CLIP_PLANES };

/* Of the view: the near plane, and one beyond each side of the picture. */
struct native_clip {
    struct native_clip_plane {
        double normal[3], offset;
    } plane[CLIP_PLANES];
};

void native_clip_init(struct native_clip *clip, const struct view *view);
/* What is left of a triangle, a convex polygon. Returns how many corners it has: 0, or 3 and more. */
int native_clip_triangle(const struct native_clip *clip, const struct native_corner triangle[3],
                         struct native_corner left[CLIP_MOST_CORNERS]);

#endif
