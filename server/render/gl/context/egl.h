/* An EGL device with a surfaceless OpenGL 4.5 core context, current on the calling thread. Where
 * the device can, the context tells that it is lost (glGetGraphicsResetStatus) and never reads or
 * writes outside of a buffer. */
#ifndef SHEEN_RENDER_GL_CONTEXT_EGL_H
#define SHEEN_RENDER_GL_CONTEXT_EGL_H

#include <stdbool.h>

#include <epoxy/egl.h>

#include "server/base/error.h"

struct egl {
    EGLDisplay display;
    EGLContext context;
    EGLDeviceEXT device;
    bool software; /* EGL_MESA_device_software */
};

/* device: "auto" (the first hardware device that can, else software), "hardware", "software", or a
 * number in EGL's enumeration. ERROR_DEVICE lists what was found. */
bool egl_init(struct egl *egl, const char *device, struct error *error);
/* Another context on the same device, in place of one that is lost. False when the device gives
 * none yet: then there is no context, and this may be tried again. */
bool egl_reopen(struct egl *egl);
void egl_finish(struct egl *egl);

#endif
