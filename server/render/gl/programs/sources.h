/* The source text of every GL program: #define lines, then the files of shaders/ in the order of
 * shaders/programs. Makes no GL call, so the texts can be made and checked on a machine without a
 * device. Private to server/render/gl. Pure functions on constant data, any thread. */
#ifndef SHEEN_RENDER_GL_PROGRAMS_SOURCES_H
#define SHEEN_RENDER_GL_PROGRAMS_SOURCES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"

enum { PROGRAM_DEFINES_BYTES = 256, PROGRAM_MAX_FILES = 20 };

/* A program: a compute shader, or a vertex and a fragment shader. */
struct program_source {
    char defines[PROGRAM_DEFINES_BYTES];
    /* The files of each shader, as in struct shader_program (shaders.h). */
    const char *const *files[2];
};

/* One shader's text in the form for glShaderSource(): the first n entries of `part`. */
struct shader_text {
    const char *part[2 + 2 * PROGRAM_MAX_FILES];
    int n;
    char line[PROGRAM_MAX_FILES][24]; /* the parts `#line 1 N`, which precede the N-th file */
};

/* Makes the text of shader k (0 or 1) of a source. The parts point into `text` and `source`, which
 * must not move while the text is used. False with ERROR_DEVICE if a file is not embedded. */
bool shader_text_init(struct shader_text *text, const struct program_source *source, int k,
                      struct error *error);

/* Programs that exist once, for all models and frames. */
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

/* Programs that read limit tables: one of each for every way in which tables are divided into
 * buffer textures. */
enum table_program {
    PROGRAM_VISIBILITY,
    PROGRAM_EVALUATE,
    PROGRAM_UNSOLVED,
    PROGRAM_ROUNDED,
    PROGRAM_ENDS,
    TABLE_PROGRAMS
};
struct table_layout {
    int n_points, n_nodes, n_adjacency; /* number of buffer textures */
    size_t max_texels;                  /* limit of a buffer texture */
    bool ptex;                          /* writes PLANE_PTEX */
};
struct program_source source_of_tables(enum table_program program,
                                       const struct table_layout *layout);

/* What a program of stage 3 computes: the colours of all pixels (filtered, or with one sample
 * each), the colours of listed pixels, the planes of light and curvature, or the share of visible
 * pixels that meet the light. */
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

/* The properties that distinguish programs of stage 3. */
struct shade_key {
    uint8_t family, light; /* enum line_family; enum light_kind, 0 if not used */
    uint8_t pattern, soft; /* enum pattern_kind; with soft edges, if they matter */
    uint8_t picture;       /* PATTERN_IMAGE: image_quirks(); else 0 */
    uint8_t which;         /* enum shaded */
    /* Several lights: the colours behind come from textures, for which drivers generate different
     * code. */
    uint8_t has_several;
};

struct program_source source_of_shading(struct shade_key key);

/* Any program. */
enum program_set { SET_SINGLE, SET_TABLES, SET_SHADING };
struct program_id {
    enum program_set set;
    int which;                  /* enum single_program or enum table_program */
    struct table_layout layout; /* of SET_TABLES */
    struct shade_key shading;   /* of SET_SHADING */
};
bool program_id_is_same(const struct program_id *a, const struct program_id *b);
struct program_source source_of_program(const struct program_id *id);

#endif
