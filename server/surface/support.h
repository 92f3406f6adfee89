/* Finds support points: a limited number of outermost points of the surface, to which a camera is
 * fitted. */
#ifndef SHEEN_SURFACE_SUPPORT_H
#define SHEEN_SURFACE_SUPPORT_H

#include "server/surface/tables.h"
#include "server/surface/watch.h"

/* Fills in tables->support after all faces are built: of many points of the surface, the outermost
 * in each cell of a cube about the surface's middle. The surface extends beyond them by less than 1
 * % of the box's diagonal. One thread. False, and no support points, with ERROR_SERVER when memory
 * is short or with the watch's error. */
bool limit_find_support(struct limit_tables *tables, const struct limit_watch *watch,
                        struct error *error);

#endif
