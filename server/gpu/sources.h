/* What every program is assembled from: files of shaders/ behind defines. No GL call is made here,
 * so that the texts can be had, and checked, without a device. Private to server/gpu. */
#ifndef SHEEN_GPU_SOURCES_H
#define SHEEN_GPU_SOURCES_H

#include "server/error.h"
#include "server/gpu/shade_programs.h"

enum { PROGRAM_DEFINES_BYTES = 256, PROGRAM_MAX_FILES = 20 };

/* A compute shader; or a vertex and a fragment shader. */
struct program_source {
    char defines[PROGRAM_DEFINES_BYTES];
    const char *const *files[2]; /* of each shader, a NULL at the end; files[1] NULL: compute */
};

/* A shader as glShaderSource() takes it. */
struct shader_text {
    const char *part[2 + 2 * PROGRAM_MAX_FILES];
    int n;
    char line[PROGRAM_MAX_FILES][24]; /* parts of it: `#line 1 N` before the N-th file */
};

/* The source's k-th shader. Both stay while the text is used. ERROR_DEVICE when a file is not
 * built in. */
bool shader_text_init(struct shader_text *text, const struct program_source *source, int k,
                      struct error *error);

/* Programs of which there is one each. */
enum single_program {
    PROGRAM_GATHER,
    PROGRAM_DOUBT,
    PROGRAM_EDGES_FIND,
    PROGRAM_POLYGONS,
    PROGRAM_WIREFRAME,
    SINGLE_PROGRAMS
};
struct program_source source_of_single(enum single_program program);

/* Those that read limit tables, for each way of spreading them over buffer textures. */
enum table_program {
    PROGRAM_VISIBILITY,
    PROGRAM_EVALUATE,
    PROGRAM_UNSOLVED,
    PROGRAM_ROUNDED,
    TABLE_PROGRAMS
};
struct table_layout {
    int point_banks, node_banks, adjacency_banks;
    size_t max_texels; /* of a buffer texture */
    bool ptex;         /* PLANE_PTEX is written */
};
struct program_source source_of_tables(enum table_program program,
                                       const struct table_layout *layout);

/* Those of stage 3. */
struct program_source source_of_shading(struct shade_key key);

#endif
