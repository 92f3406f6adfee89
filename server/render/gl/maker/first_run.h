/* First runs of programs of stage 3, over no pixel: a software device generates a program's code when it
 * first runs in a context, which takes most of the time of a compilation; and it generates other code
 * if other kinds of textures are bound. The thread of one context. */
#ifndef SHEEN_RENDER_GL_MAKER_FIRST_RUN_H
#define SHEEN_RENDER_GL_MAKER_FIRST_RUN_H

#include "server/render/gl/programs/sources.h"
#include "server/render/gl/target.h"

enum { N_PICTURE_KINDS = 16 }; /* values of image_quirks() */

/* The least objects with which programs can run. They are made when first needed, and end with
 * their context. All zero: none. */
struct first_runs {
    struct target target[2]; /* without and with the planes of several lights */
    GLuint picture[N_PICTURE_KINDS], blank;
    GLuint no_groups;
};

/* Runs a program in a context that draws nothing else. */
void first_run(struct first_runs *runs, const struct shade_key *key, GLuint program);

#endif
