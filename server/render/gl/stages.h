/* The programs and buffers of each stage on the device. All zero: nothing. GL thread. */
#ifndef SHEEN_RENDER_GL_STAGES_H
#define SHEEN_RENDER_GL_STAGES_H

#include <epoxy/gl.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/render/patch_grids.h"

/* Stage 1: visibility.h. */
struct visibility_stage {
    GLuint vertex_array;
    GLuint index_buffer; /* indices of an instance, for each shape of grid */
    size_t index_first[GRID_SHAPES];
    GLuint grid_buffer, grid_texture; /* the grids to draw, and a texture of them */
};

/* Between stages 1 and 2: gather.h. */
struct gather_stage {
    GLuint program;
    GLuint block_buffer; /* the blocks of the last tile */
};

/* Stage 2: evaluate.h. */
struct evaluate_stage {
    GLuint recheck, gaps;         /* programs */
    GLuint gap_ends, gap_guesses; /* buffers: shaders/unsolved.comp.glsl */
    bool too_many_gaps;           /* the last tile has more than MAX_GAPS, so its gaps stay empty */
};

/* Coverage: edges.h. */
struct edges_stage {
    GLuint find, recheck; /* programs */
};

/* Polygons instead of stages 1 and 2: polygon.h. Made at first use. */
struct polygon_stage {
    GLuint framebuffer;
};

/* Stage 3: shade.h. */
struct shade_stage {
    GLuint light_buffer;
    GLuint blank_texture; /* used if a pattern has no image */
    GLuint no_groups;     /* shade_no_groups() */
};

/* The times of stages: stage_clock.h. */
enum { MAX_CLOCKED_STAGES = 3 };
struct stage_clock {
    GLuint mark[MAX_CLOCKED_STAGES][2];  /* queries: start and end of each stage on the device */
    uint64_t *stage[MAX_CLOCKED_STAGES]; /* where the stage's time is added */
    int n;                               /* number of stages ended since the last reading */
    uint64_t since_us;                   /* time of the last reading */
};

#endif
