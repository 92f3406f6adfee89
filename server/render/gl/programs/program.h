/* GL programs out of their sources. GL thread only. */
#ifndef SHEEN_RENDER_GL_PROGRAMS_PROGRAM_H
#define SHEEN_RENDER_GL_PROGRAMS_PROGRAM_H

#include <epoxy/gl.h>

#include "server/render/gl/programs/sources.h"

/* Compiles and links. 0 on failure, with the compiler's first line in the error. */
GLuint program_create(const struct program_source *source, struct error *error);
GLuint program_create_single(enum single_program program, struct error *error);

#endif
