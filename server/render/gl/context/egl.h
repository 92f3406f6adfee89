/* An EGL device with an OpenGL 4.5 core context without a surface, current on the calling thread.
 * If the device supports it, the context reports its loss (glGetGraphicsResetStatus) and never
 * accesses memory outside of buffers. */
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

/* device: "auto" (the first usable hardware device, else software), "hardware", "software", or a
 * number in EGL's enumeration. False with ERROR_DEVICE, which lists the devices found. */
bool egl_init(struct egl *egl, const char *device, struct error *error);
/* Opens another context on the same device, instead of a lost one. False if the device gives none
 * yet: then there is no context, and the call may be repeated. */
bool egl_reopen(struct egl *egl);
void egl_finish(struct egl *egl);

#endif
