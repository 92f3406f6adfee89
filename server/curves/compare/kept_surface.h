/* A surface prepared for many evaluations at any place: its leaves (nodes with points), and the
 * points of their first levels, because tables on demand would make these points again for each
 * evaluation. Levels beyond those are made when they are needed. At a pole (a vertex with ten or
 * more faces) the points of all levels are kept, if they take at most 16 MiB and fit into the
 * memory that kept_surface_init() may use. Optionally the surface is moved by a rigid motion.
 *
 * kept_surface_fill() may run for different leaves at the same time. One thread calls
 * kept_surface_init() and kept_surface_finish(). A filled surface is read-only, and any thread may
 * read it. */
#ifndef SHEEN_CURVES_COMPARE_KEPT_SURFACE_H
#define SHEEN_CURVES_COMPARE_KEPT_SURFACE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"
#include "server/surface/evaluate.h"
#include "server/surface/patch.h"

/* A rotation, row by row, and then a translation. */
struct rigid_motion {
    struct vec row[3], shift;
};

/* A node with points. Places on it are local (x,y) in [0,1], as in limit_patch_of_level(). */
struct kept_leaf {
    uint32_t node;
    uint32_t first_level; /* in kept_surface.levels */
    double area;          /* estimated */
    uint32_t corner;      /* only for a CORNER: its number among the CORNERs, from 0 */
    /* Number of levels that are parts, from level 1; 1 for a REGULAR node (level 0). */
    uint8_t n_levels;
    uint8_t n_kept; /* number of levels whose points are kept, at least n_levels */
};

struct kept_surface {
    const struct limit_tables *tables; /* outlive the surface */
    struct kept_leaf *leaves;
    size_t n_leaves;
    struct limit_patch *levels;
    size_t n_levels;  /* whose points are kept */
    size_t n_corners; /* leaves that are CORNERs */
    bool is_moved;
    struct rigid_motion motion;
};

/* The most levels of a CORNER that are parts (kept_surface_parts()). The area beyond them is
 * 4^-KEPT_LEVELS of the CORNER's area. At a pole the points of more levels may be kept. */
enum { KEPT_LEVELS = 5 };

/* Lists the leaves and makes room for their levels, in at most `most_bytes`. If `most_bytes` is too
 * small for all levels, fewer levels of each CORNER are kept. Returns false with ERROR_SERVER if
 * one level of each CORNER does not fit, or when memory is short; there is then nothing to
 * finish. */
bool kept_surface_init(struct kept_surface *surface, const struct limit_tables *tables,
                       size_t most_bytes, struct error *error);
void kept_surface_finish(struct kept_surface *surface);
/* The bytes of a surface that keeps as much as any does, and the number of its parts. */
size_t kept_surface_most_bytes(const struct limit_tables *tables, size_t *n_parts);
size_t kept_surface_bytes(const struct kept_surface *surface);
/* Makes the levels of a leaf and estimates its area. */
void kept_surface_fill(struct kept_surface *surface, size_t leaf);

static inline const struct limit_node *kept_node(const struct kept_surface *surface, size_t leaf)
{
    return &surface->tables->nodes[surface->leaves[leaf].node];
}

/* The rectangles [x, x + width] x [y, y + height] of a leaf that its kept levels cover, one for
 * each patch; the last one of a CORNER is the rest about the vertex (is_rest), which consists of
 * many patches. Returns their number. */
struct kept_part {
    double x, y, width, height;
    bool is_rest;
};
enum { KEPT_PARTS = 3 * KEPT_LEVELS + 1 };
unsigned kept_surface_parts(const struct kept_surface *surface, size_t leaf,
                            struct kept_part parts[KEPT_PARTS]);

/* Evaluates local (x,y) of a leaf, which may lie slightly outside [0,1]. Derivatives are by x and
 * y. At (0,0) of a CORNER the result is the vertex (evaluate.h). Between the vertex and its last
 * level, the result is the inner corner of the last level. */
void kept_surface_evaluate(const struct kept_surface *surface, size_t leaf, double x, double y,
                           struct limit_point *out);

/* The levels that evaluations have made last, because they are not kept: level n in slot n %
 * MADE_LEVELS. It must not be copied, because patches point into themselves. */
enum { MADE_LEVELS = 4 };
struct made_levels {
    const struct limit_node
        *node[MADE_LEVELS]; /* NULL: none; the slot's level is then uninitialised */
    struct limit_patch level[MADE_LEVELS];
};
static inline void made_levels_init(struct made_levels *made)
{
    for (int k = 0; k < MADE_LEVELS; k++)
        made->node[k] = NULL;
}
/* As kept_surface_evaluate(); points of levels in `made` are not made again. `made` may be NULL. */
void kept_surface_evaluate_again(const struct kept_surface *surface, size_t leaf, double x,
                                 double y, struct made_levels *made, struct limit_point *out);

/* Gets the Bezier net, in world coordinates, of a part that is one patch (not the rest): net[4 j +
 * i]. */
void kept_surface_net(const struct kept_surface *surface, size_t leaf, const struct kept_part *part,
                      struct vec net[16]);

struct vec motion_turn(const struct rigid_motion *motion, struct vec v);

/* The face and its (u,v) at local (x,y) of a leaf. */
void kept_surface_place(const struct kept_surface *surface, size_t leaf, double x, double y,
                        uint32_t *face, double uv[2]);

/* True if local (x,y) of a leaf, within 1e-6 of a face, lies where the surface ends: at an edge of
 * its face across which there is no face, or a hole. An edge that is one point, such as a pole, is
 * no end. */
bool kept_surface_at_border(const struct kept_surface *surface, size_t leaf, double x, double y);

#endif
