/* How far the surface reaches in any direction: points on it that lie outermost, few whatever the
 * model's size. What a camera is fitted to. */
#ifndef SHEEN_SURFACE_SUPPORT_H
#define SHEEN_SURFACE_SUPPORT_H

#include "server/surface/tables.h"
#include "server/surface/watch.h"

/* Fills in tables->support once all faces are built: of many points of the surface the outermost in
 * each cell of a cube about its middle. The surface reaches beyond them by less than 1 % of the
 * box's diagonal. One thread. False, and no support points: ERROR_SERVER when memory is short, or
 * the watch's error. */
bool limit_find_support(struct limit_tables *tables, const struct limit_watch *watch,
                        struct error *error);

#endif
