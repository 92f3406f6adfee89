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
    bool software;  /* EGL_MESA_device_software */
    int robustness; /* which attributes the device took for the context */
};

/* device: "auto" (the first usable hardware device, else software), "hardware", "software", or a
 * number in EGL's enumeration. False with ERROR_DEVICE, which lists the devices found. */
bool egl_init(struct egl *egl, const char *device, struct error *error);
/* Opens another context on the same device, instead of a lost one. False if the device gives none
 * yet: then there is no context, and the call may be repeated. */
bool egl_reopen(struct egl *egl);
/* Another context of the device, which shares the names of programs, buffers and textures with the
 * first one; it is not current. EGL_NO_CONTEXT on failure. The caller destroys it before
 * egl_finish() and egl_reopen(). */
EGLContext egl_create_sharing(const struct egl *egl);
/* Makes a context current on the calling thread; EGL_NO_CONTEXT: none. Any thread. */
bool egl_make_current(const struct egl *egl, EGLContext context);
void egl_finish(struct egl *egl);

#endif
