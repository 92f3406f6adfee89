/* Graphics processors, and Mesa's software device: EGL by device enumeration, without a surface,
 * OpenGL 4.5 core. renderer_options.device is "auto" (NULL: a GPU, else Mesa), "hardware",
 * "software" (Mesa) or a number: the n-th EGL device.
 *
 * The device is lost when the driver resets it, or when its work does not end within 2 s (a
 * software device may take any time). renderer_info.software: EGL says so
 * (EGL_MESA_device_software). Included by server/ops, which chooses a device, and by tests. */
#ifndef SHEEN_RENDER_GL_DEVICE_H
#define SHEEN_RENDER_GL_DEVICE_H

struct renderer_device;

extern const struct renderer_device gl_device;

#endif
