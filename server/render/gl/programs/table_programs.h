/* The programs that read limit tables: one set for each way in which tables are spread over buffer
 * textures, of which the sets used last are kept. GL thread. */
#ifndef SHEEN_RENDER_GL_PROGRAMS_TABLE_PROGRAMS_H
#define SHEEN_RENDER_GL_PROGRAMS_TABLE_PROGRAMS_H

#include <epoxy/gl.h>

#include <stdint.h>

#include "server/base/error.h"
#include "server/render/gl/programs/sources.h"

struct table_programs {
    struct table_layout layout;
    GLuint visibility, evaluate, unsolved, rounded, ends;
    uint64_t used; /* by the clock of the sets */
};

/* Most models take one or two: their tables fill a buffer texture each. */
enum { MAX_PROGRAM_SETS = 4 };

/* All zero: none. */
struct program_sets {
    struct table_programs set[MAX_PROGRAM_SETS];
    int n;
    uint64_t clock;
};

/* The programs for tables that are spread in this way, until the next call: compiled where they are
 * not kept, in place of those not asked for for longest where there is no room. NULL with
 * ERROR_DEVICE when the driver cannot. */
const struct table_programs *programs_for(struct program_sets *sets,
                                          const struct table_layout *layout, struct error *error);

#endif
