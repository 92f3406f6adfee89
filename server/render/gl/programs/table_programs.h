/* Keeps the programs that read limit tables: one set for each way in which tables are divided into
 * buffer textures; the most recently used sets are kept. GL thread. */
#ifndef SHEEN_RENDER_GL_PROGRAMS_TABLE_PROGRAMS_H
#define SHEEN_RENDER_GL_PROGRAMS_TABLE_PROGRAMS_H

#include <epoxy/gl.h>

#include <stdint.h>

#include "server/base/error.h"
#include "server/render/gl/programs/sources.h"

struct table_programs {
    struct table_layout layout;
    GLuint visibility, evaluate, unsolved, rounded, ends;
    uint64_t used; /* time of the last use, by the clock of struct program_sets */
};

/* Most models need one or two, because each of their tables fits into one buffer texture. */
enum { MAX_PROGRAM_SETS = 4 };

/* All zero: no sets. */
struct program_sets {
    struct table_programs set[MAX_PROGRAM_SETS];
    int n;
    uint64_t clock;
};

/* The programs for tables with this layout, valid until the next call. They are compiled if they
 * are not kept; if there is no room, they replace the least recently requested set. NULL with
 * ERROR_DEVICE if the driver fails. */
const struct table_programs *programs_for(struct program_sets *sets,
                                          const struct table_layout *layout, struct error *error);

#endif
