/* The GL device: GPUs, and Mesa's software device. It enumerates EGL devices and uses OpenGL 4.5
 * core without a surface. renderer_options.device is "auto" (or NULL: a GPU, else Mesa),
 * "hardware", "software" (Mesa), or a number: the n-th EGL device.
 *
 * The device counts as lost when the driver resets it, or when its work does not end within 2 s (a
 * software device may take any time). renderer_info.software is what EGL says
 * (EGL_MESA_device_software). Included by server/ops, which chooses a device, and by tests. */
#ifndef SHEEN_RENDER_GL_DEVICE_H
#define SHEEN_RENDER_GL_DEVICE_H

struct renderer_device;

extern const struct renderer_device gl_device;

#endif
