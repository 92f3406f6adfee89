/* Graphics processors, and Mesa's software device: EGL by device enumeration, without a surface,
 * OpenGL 4.5 core. renderer_options.device is "auto", "software" or a number: the n-th EGL device.
 *
 * The device is lost by a reset, or by work that does not end: in 2 s, but a software device has
 * all time. renderer_info.software: EGL says so (EGL_MESA_device_software). For who chooses a
 * device, and for tests. */
#ifndef SHEEN_RENDER_GL_DEVICE_H
#define SHEEN_RENDER_GL_DEVICE_H

struct renderer_device;

extern const struct renderer_device gl_device;

#endif
