/* Processors, by vector code: no GL, no shader compiler. renderer_options.device is not asked.
 *
 * Every instruction set that the processor has draws the same picture but for rounding; any number of
 * threads draws the same bytes. It draws no polygons and wireframes yet: their frames fail with
 * ERROR_REQUEST. For who chooses a device, and for tests. */
#ifndef SHEEN_RENDER_NATIVE_DEVICE_H
#define SHEEN_RENDER_NATIVE_DEVICE_H

struct renderer_device;

extern const struct renderer_device native_renderer_device;

#endif
