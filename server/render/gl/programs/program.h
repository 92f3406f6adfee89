/* Makes GL programs from their sources. GL thread only. */
#ifndef SHEEN_RENDER_GL_PROGRAMS_PROGRAM_H
#define SHEEN_RENDER_GL_PROGRAMS_PROGRAM_H

#include <epoxy/gl.h>

#include "server/render/gl/programs/sources.h"

/* Compiles and links a program. 0 on failure; the error has the compiler's first line. */
GLuint program_create(const struct program_source *source, struct error *error);
GLuint program_create_single(enum single_program program, struct error *error);

#endif
