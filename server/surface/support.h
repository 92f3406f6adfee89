/* How far the surface reaches in any direction: points on it that lie outermost, few whatever the
 * model's size. What a camera is fitted to. */
#ifndef SHEEN_SURFACE_SUPPORT_H
#define SHEEN_SURFACE_SUPPORT_H

#include "server/surface/tables.h"

/* Over the sides of the box, by direction from its middle: so many cells along each side of each.
 */
#define SUPPORT_SIDE 16
#define SUPPORT_MAX_POINTS (6 * SUPPORT_SIDE * SUPPORT_SIDE)

/* How many points tables may have, known before they are built: a model without surface has none.
 */
size_t limit_support_room(const struct limit_tables *tables);

/* Fills in tables->support once all faces are built: the outermost of many points of the surface in
 * each cell. The surface reaches beyond them by less than 1 % of the box's diagonal. Asks the watch
 * as limit_build_faces() does. */
bool limit_find_support(struct limit_tables *tables, const struct limit_watch *watch,
                        struct error *error);

#endif
