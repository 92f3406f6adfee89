/* The native device: draws on processors by vector code, without GL and without a shader compiler. It ignores
 * renderer_options.device.
 *
 * All instruction sets draw the same picture except for rounding; any number of threads draws the same bytes.
 * Included by server/ops, which chooses a device, and by tests. */
#ifndef SHEEN_RENDER_NATIVE_DEVICE_H
#define SHEEN_RENDER_NATIVE_DEVICE_H

struct renderer_device;

extern const struct renderer_device native_renderer_device;

#endif
