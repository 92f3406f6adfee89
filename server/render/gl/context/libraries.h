/* Loads the shared libraries of EGL and OpenGL. libepoxy loads them when one of its functions is
 * first called, and ends the process if one is missing, so call libraries_load() first. */
#ifndef SHEEN_RENDER_GL_CONTEXT_LIBRARIES_H
#define SHEEN_RENDER_GL_CONTEXT_LIBRARIES_H

#include <stdbool.h>

#include "server/base/error.h"

/* Loads the libraries for the rest of the process. False with ERROR_DEVICE, which names the missing
 * library and its Debian package. Any thread. */
bool libraries_load(struct error *error);

#endif
