/* Keeps the most recently used programs of stage 3. Private to server/render/gl; GL thread only. */
#ifndef SHEEN_RENDER_GL_PROGRAMS_SHADE_PROGRAMS_H
#define SHEEN_RENDER_GL_PROGRAMS_SHADE_PROGRAMS_H

#include <epoxy/gl.h>
#include <stdbool.h>
#include <stdint.h>

#include "server/base/error.h"
#include "server/render/gl/programs/sources.h"
#include "server/scene/frame_request.h"

enum {
    /* The most programs that one frame needs: five for each light, and one for its planes. */
    MAX_FRAME_PROGRAMS = 5 * MAX_LIGHTS + 1,
    /* On Mesa's software device a program takes 3.5 MB of main memory: 170 MB for all. */
    MAX_SHADE_PROGRAMS = 48
};

struct shade_program {
    struct shade_key key;
    GLuint name;
    bool is_made;  /* has run once, when drivers generate its code */
    uint64_t used; /* time of the last use, by `clock` */
};

/* All zero: no programs. The programs are deleted with their context. */
struct shade_programs {
    struct shade_program kept[MAX_SHADE_PROGRAMS];
    int n;
    uint64_t clock;
};

/* A frame or tile begins: programs requested from here on stay until the next call, at most
 * MAX_FRAME_PROGRAMS. */
void shade_programs_begin(struct shade_programs *programs);

/* Finds a program; NULL if it is not kept. */
struct shade_program *shade_programs_find(struct shade_programs *programs, struct shade_key key);

/* Compiles a program that is not kept. If there is no room, it replaces the least recently
 * requested one. NULL with ERROR_DEVICE if the driver fails. */
struct shade_program *shade_programs_compile(struct shade_programs *programs, struct shade_key key,
                                             struct error *error);

#endif
