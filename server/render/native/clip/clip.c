#include "server/render/native/clip/clip.h"

#include <math.h>
#include <string.h>

/* Triangles are cut off this far outside the picture. */
static const double MARGIN_PX = 64;

/* At least 0 on the plane's inner side. */
static double above(const struct native_clip_plane *plane, const struct native_corner *c)
{
    return plane->normal[0] * c->at[0] + plane->normal[1] * c->at[1] + plane->normal[2] * c->at[2] +
           plane->offset;
}

/* The near plane comes first: only what is in front of it has a place in the picture. */
void native_clip_init(struct native_clip *clip, const struct view *view)
{
    const double size[2] = {view->width_px, view->height_px};
    clip->plane[0] = (struct native_clip_plane){{0, 0, 1}, -view->near};
    for (int k = 0; k < 2; k++) {
        double low = (view->centre_px[k] + MARGIN_PX) * view->units_per_px;
        double high = (size[k] - view->centre_px[k] + MARGIN_PX) * view->units_per_px;
        struct native_clip_plane *first = &clip->plane[1 + 2 * k], *second = first + 1;
        *first = (struct native_clip_plane){{0, 0, view->perspective ? low : 0},
                                            view->perspective ? 0 : low};
        *second = (struct native_clip_plane){{0, 0, view->perspective ? high : 0},
                                             view->perspective ? 0 : high};
        first->normal[k] = 1;
        second->normal[k] = -1;
    }
}

static bool is_beyond(const struct native_clip_plane *plane, const struct native_corner *points,
                      int n, double off)
{
    const double *to = plane->normal;
    double least = -off * sqrt(to[0] * to[0] + to[1] * to[1] + to[2] * to[2]);
    for (int i = 0; i < n; i++)
        if (!(above(plane, &points[i]) < least))
            return false;
    return true;
}

bool native_clip_excludes(const struct native_clip *clip, const struct native_corner *points, int n,
                          double off)
{
    for (int p = 0; p < CLIP_PLANES; p++)
        if (is_beyond(&clip->plane[p], points, n, off))
            return true;
    return false;
}

static struct native_corner between(const struct native_corner *a, const struct native_corner *b,
                                    double share)
{
    struct native_corner c = {.s = a->s + share * (b->s - a->s), .t = a->t + share * (b->t - a->t)};
    for (int k = 0; k < 3; k++)
        c.at[k] = a->at[k] + share * (b->at[k] - a->at[k]);
    return c;
}

/* Writes the part of a convex polygon on the inner side of a plane. */
static int cut(const struct native_clip_plane *plane, const struct native_corner *in, int n,
               struct native_corner *out)
{
    int left = 0;
    for (int i = 0; i < n; i++) {
        const struct native_corner *a = &in[i], *b = &in[(i + 1) % n];
        double up_a = above(plane, a), up_b = above(plane, b);
        if (up_a >= 0)
            out[left++] = *a;
        if ((up_a >= 0) != (up_b >= 0))
            out[left++] = between(a, b, up_a / (up_a - up_b));
    }
    return left;
}

int native_clip_triangle(const struct native_clip *clip, const struct native_corner triangle[3],
                         struct native_corner left[CLIP_MOST_CORNERS])
{
    struct native_corner before[CLIP_MOST_CORNERS];
    int n = 3;
    memcpy(left, triangle, 3 * sizeof *triangle);
    for (int p = 0; p < CLIP_PLANES && n; p++) {
        memcpy(before, left, (size_t)n * sizeof *left);
        n = cut(&clip->plane[p], before, n, left);
    }
    return n < 3 ? 0 : n;
}
