/* Reads .bpt files: Bezier patches. Internal to server/cage/read. Any thread. */
#ifndef SHEEN_CAGE_READ_BPT_H
#define SHEEN_CAGE_READ_BPT_H

#include "server/cage/build/builder.h"

/* Reads a whole file into an empty builder: the number of patches; of each its degrees m and n, 1
 * to 3, then (m + 1)(n + 1) points, m + 1 of them along u in each row. False with ERROR_MODEL,
 * which names `name` and the line, or with ERROR_SERVER when memory is short. */
bool bpt_read(struct cage_builder *builder, const void *bytes, size_t size, const char *name,
              struct error *error);

#endif
