/* An EGL device with a surfaceless OpenGL 4.5 core context, current on the calling thread. */
#ifndef SHEEN_GPU_EGL_H
#define SHEEN_GPU_EGL_H

#include <stdbool.h>

#include <epoxy/egl.h>

#include "server/error.h"

struct egl {
    EGLDisplay display;
    EGLContext context;
    bool software; /* EGL_MESA_device_software */
};

/* device: "auto" (the first hardware device that can, else software), "software", or a number in
 * EGL's enumeration. ERROR_DEVICE lists what was found. */
bool egl_init(struct egl *egl, const char *device, struct error *error);
void egl_finish(struct egl *egl);

#endif
