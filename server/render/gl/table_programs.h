/* The programs that read limit tables: one set for each way in which tables are spread over buffer
 * textures, of which the sets used last are kept. GL thread. */
#ifndef SHEEN_RENDER_GL_TABLE_PROGRAMS_H
#define SHEEN_RENDER_GL_TABLE_PROGRAMS_H

#include <epoxy/gl.h>

#include <stdbool.h>
#include <stdint.h>

#include "server/base/error.h"

struct gl_model;
struct gl_renderer;

/* For tables in so many buffer textures, writing PLANE_PTEX or not. */
struct table_programs {
    int n_points, n_nodes, n_adjacency;
    bool ptex;
    GLuint visibility, evaluate, unsolved, rounded, silhouette;
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

/* The programs for a model that is on the device, until the next call: compiled where they are not
 * kept, in place of those not asked for for longest where there is no room. NULL with ERROR_DEVICE
 * when the driver cannot. */
const struct table_programs *programs_for(struct gl_renderer *r, const struct gl_model *model,
                                          bool ptex, struct error *error);

#endif
