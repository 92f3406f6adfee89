/* Converts GL errors to errors of the daemon. GL thread. */
#ifndef SHEEN_RENDER_GL_CONTEXT_CHECK_H
#define SHEEN_RENDER_GL_CONTEXT_CHECK_H

#include "server/base/error.h"

/* Returns false with ERROR_DEVICE if a GL error is pending; `doing` names the action. */
bool gpu_check(const char *doing, struct error *error);

#endif
