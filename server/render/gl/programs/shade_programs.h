/* The programs of stage 3 that are kept: those used last. Private to server/render/gl; GL thread
 * only. */
#ifndef SHEEN_RENDER_GL_PROGRAMS_SHADE_PROGRAMS_H
#define SHEEN_RENDER_GL_PROGRAMS_SHADE_PROGRAMS_H

#include <epoxy/gl.h>
#include <stdbool.h>
#include <stdint.h>

#include "server/base/error.h"
#include "server/render/gl/programs/sources.h"
#include "server/scene/frame_request.h"

enum {
    /* One frame needs so many at most: five for each light, and one for its planes. */
    MAX_FRAME_PROGRAMS = 5 * MAX_LIGHTS + 1,
    /* On Mesa's software device a program takes 3.5 MB of main memory: 170 MB for all. */
    MAX_SHADE_PROGRAMS = 48
};

struct shade_program {
    struct shade_key key;
    GLuint name;
    bool is_made;  /* it has run once: drivers generate its code then */
    uint64_t used; /* by the clock */
};

/* All zero: none. Deleted with its context. */
struct shade_programs {
    struct shade_program kept[MAX_SHADE_PROGRAMS];
    int n;
    uint64_t clock;
};

/* Another frame begins, or another tile: what is asked for from here on stays until the next
 * beginning, MAX_FRAME_PROGRAMS at most. */
void shade_programs_begin(struct shade_programs *programs);

/* NULL where it is not kept. */
struct shade_program *shade_programs_find(struct shade_programs *programs, struct shade_key key);

/* Compiles one that is not kept, in place of the one not asked for for longest where there is no
 * room. NULL with ERROR_DEVICE when the driver cannot. */
struct shade_program *shade_programs_compile(struct shade_programs *programs, struct shade_key key,
                                             struct error *error);

#endif
