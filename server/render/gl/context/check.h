/* GL errors as errors of the daemon. GL thread. */
#ifndef SHEEN_RENDER_GL_CONTEXT_CHECK_H
#define SHEEN_RENDER_GL_CONTEXT_CHECK_H

#include "server/base/error.h"

/* Turns a pending GL error into ERROR_DEVICE; `doing` names what was tried. */
bool gpu_check(const char *doing, struct error *error);

#endif
