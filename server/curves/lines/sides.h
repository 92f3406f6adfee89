/* Where lines cross a border: a side of a face, of a node, or between two parts of a node. Roots
 * are found once on each border, from the patches on one side of it, and used on both. */
#ifndef SHEEN_LINES_SIDES_H
#define SHEEN_LINES_SIDES_H

#include "server/curves/computation.h"
#include "server/curves/fields/line_set.h"
#include "server/surface/tables.h"

/* A line crosses the border: its F changes sign. */
struct side_root {
    uint32_t line;
    double t;      /* from 0 to 1 along the border */
    uint64_t node; /* the number of this crossing */
};

/* Roots in the order of lines, then of t. */
struct root_list {
    struct side_root *root;
    size_t n, room;
};

/* A slice's memory and failures. */
struct sides_work {
    const struct limit_tables *tables;
    const struct line_set *set;
    const uint8_t *levels;           /* of each node: how many levels of a CORNER are traced */
    uint64_t next_node;              /* the number of the next crossing */
    bool failed;                     /* memory was short */
    struct computation *computation; /* once it is cancelled, roots may be missing */
};

/* Appends a root; sets work->failed when memory is short. */
void root_list_add(struct sides_work *work, struct root_list *list, struct side_root root);
void root_list_finish(struct root_list *list);

/* Appends what of `from` lies between t = a and t = b, as seen from that part. */
void root_list_part(struct sides_work *work, const struct root_list *from, double a, double b,
                    struct root_list *to);
/* Appends the roots of the same border run through the other way. */
void root_list_reversed(struct sides_work *work, const struct root_list *from,
                        struct root_list *to);
/* Flips the sign of each line for each of its roots. */
void root_list_cross(const struct root_list *list, struct line_signs *signs);

/* The signs at `t` of a border whose start has the signs `start`. */
void root_list_signs(const struct root_list *list, const struct line_signs *start, double t,
                     struct line_signs *signs);

/* Sides are numbered counter-clockwise: side k runs from corner k to the next corner. Of a node: of
 * its cell, whose corners are at (0,0) (1,0) (1,1) (0,1) of the face's (u,v). */

/* Finds the roots on a side of a node, for all lines, from the node's own patches. The signs at its
 * start are `signs`, and at its end `end`: where the patches do not agree with them, which rounding
 * can cause, a root is added. On return `signs` are those at the end; with `end` NULL the patches
 * decide. */
void sides_find(struct sides_work *work, uint32_t node, unsigned side, struct line_signs *signs,
                const struct line_signs *end, struct root_list *list);

/* The same for a side of one patch, in the patch's own parameters; the border is run through from t
 * = from to t = to, and backwards if `from` is above `to`. The roots of several patches are put in
 * order by sides_sort(). */
void sides_find_patch(struct sides_work *work, const struct limit_patch *patch, unsigned side,
                      double from, double to, struct line_signs *signs, struct root_list *list);
/* Adds roots at `t` for lines whose signs differ from `wanted`. */
void sides_agree(struct sides_work *work, double t, struct line_signs *signs,
                 const struct line_signs *wanted, struct root_list *list);
void sides_sort(struct root_list *list);

/* Finds the patch of a level of a CORNER (from 1) at the quarter `corner` (1 to 3, in local order)
 * of the square of side 2^(1 - level) at its vertex; of a STRIP, patch `level`, with corner 0; of a
 * REGULAR node both 0. */
void sides_patch(const struct sides_work *work, uint32_t node, int level, unsigned corner,
                 struct limit_patch *patch);

#endif
