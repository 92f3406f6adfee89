/* GL programs out of the embedded shader files. */
#ifndef SHEEN_GPU_PROGRAM_H
#define SHEEN_GPU_PROGRAM_H

#include <epoxy/gl.h>

#include "server/error.h"

/* Compiles and links. Each stage is `defines` ("#define A 1\n...") followed by files in order, a
 * NULL at the end. 0 on failure, with the compiler's first line in the error. */
GLuint program_compute(const char *defines, const char *const *files, struct error *error);
GLuint program_raster(const char *defines, const char *const *vertex_files,
                      const char *const *fragment_files, struct error *error);

#endif
