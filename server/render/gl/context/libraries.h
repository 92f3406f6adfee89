/* Checks for the shared libraries of EGL and OpenGL. libepoxy loads them when one of its functions
 * is first called, and ends the process where one is missing, so libraries_load() comes before. */
#ifndef SHEEN_RENDER_GL_CONTEXT_LIBRARIES_H
#define SHEEN_RENDER_GL_CONTEXT_LIBRARIES_H

#include <stdbool.h>

#include "server/base/error.h"

/* Loads them for as long as the process runs. False: ERROR_DEVICE, which names the missing library
 * and its Debian package. Any thread. */
bool libraries_load(struct error *error);

#endif
