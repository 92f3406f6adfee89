/* The source text of every GPU program: #define lines, then the files of shaders/ that shaders/programs
 * lists, in order. No GL call is made here, so the texts can be made and checked on a machine without
 * a device. Private to server/render/gl; pure functions on constant data, any thread. */
#ifndef SHEEN_RENDER_GL_PROGRAMS_SOURCES_H
#define SHEEN_RENDER_GL_PROGRAMS_SOURCES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"

enum { PROGRAM_DEFINES_BYTES = 256, PROGRAM_MAX_FILES = 20 };

/* A compute shader; or a vertex and a fragment shader. */
struct program_source {
    char defines[PROGRAM_DEFINES_BYTES];
    const char *const *files[2]; /* of each shader, as struct shader_program has them (shaders.h) */
};

/* One shader's text as glShaderSource() takes it: part[0, n). */
struct shader_text {
    const char *part[2 + 2 * PROGRAM_MAX_FILES];
    int n;
    char line[PROGRAM_MAX_FILES][24]; /* the parts `#line 1 N`, which stand before the N-th file */
};

/* Fills the text of shader k (0 or 1) of a source. The parts point into `text` and `source`, which
 * must both stay in place while the text is used. ERROR_DEVICE when a file is not built in. */
bool shader_text_init(struct shader_text *text, const struct program_source *source, int k,
                      struct error *error);

/* The programs of which there is one for all models and frames. */
enum single_program {
    PROGRAM_GATHER,
    PROGRAM_RECHECK,
    PROGRAM_GAPS,
    PROGRAM_EDGES_FIND,
    PROGRAM_EDGES_RECHECK,
    PROGRAM_POLYGONS,
    PROGRAM_WIREFRAME,
    SINGLE_PROGRAMS
};
struct program_source source_of_single(enum single_program program);

/* The programs that read limit tables: one of each for each way of spreading the tables over buffer
 * textures. */
enum table_program {
    PROGRAM_VISIBILITY,
    PROGRAM_EVALUATE,
    PROGRAM_UNSOLVED,
    PROGRAM_ROUNDED,
    PROGRAM_ENDS,
    TABLE_PROGRAMS
};
struct table_layout {
    int n_points, n_nodes, n_adjacency; /* buffer textures */
    size_t max_texels;                  /* of a buffer texture */
    bool ptex;                          /* PLANE_PTEX is written */
};
struct program_source source_of_tables(enum table_program program,
                                       const struct table_layout *layout);

/* What a program of stage 3 makes: the colours of all pixels (filtered, or by one sample each), the
 * colours of listed pixels, the planes of light and curvature, or the share of the seen pixels that
 * meet the light. */
enum shaded {
    SHADED_ALL,
    SHADED_UNFILTERED,
    SHADED_EDGES,
    SHADED_HIGH_CURVATURE,
    SHADED_ROUNDED,
    SHADED_PLANES,
    SHADED_SHARE,
    SHADED_KINDS
};

/* What tells one program of stage 3 from another. */
struct shade_key {
    uint8_t family, light; /* enum line_family; enum light_kind, 0 where it plays no part */
    uint8_t pattern, soft; /* enum pattern_kind; with soft edges, where they change something */
    uint8_t picture;       /* of PATTERN_IMAGE: image_quirks(); else 0 */
    uint8_t which;         /* enum shaded */
    uint8_t has_several;   /* lights: the colours behind come from textures, for which drivers have
                              code of their own */
};

struct program_source source_of_shading(struct shade_key key);

#endif
