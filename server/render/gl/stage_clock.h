/* Measures the time of a tile's stages: by timer queries on the device, so that it does not pause
 * between stages, or by the clock, waiting for the device after each stage. GL thread. */
#ifndef SHEEN_RENDER_GL_STAGE_CLOCK_H
#define SHEEN_RENDER_GL_STAGE_CLOCK_H

#include <epoxy/gl.h>

#include <stdbool.h>
#include <stdint.h>

struct gl_renderer;

/* True if the device has timer queries that measure all of its work. */
bool stage_clock_by_device(const struct gl_renderer *renderer);
void stage_clock_init(struct gl_renderer *renderer);
/* A tile begins. When measuring by the clock, the processor's time from here on counts for the
 * tile's first stage. */
void stage_clock_begin(struct gl_renderer *renderer);
/* Call them before and after the commands of a stage. The stage's time is added to *stage: at once
 * when measuring by the clock, after waiting for the device; else in stage_clock_read(), until
 * which the pointer must stay valid. False when the device is lost. */
void stage_clock_start(struct gl_renderer *renderer);
bool stage_clock_end(struct gl_renderer *renderer, uint64_t *stage);
/* Waits for ended stages, if needed, and adds their times. False when the device is lost. */
bool stage_clock_read(struct gl_renderer *renderer);
/* Waits for the device and adds the elapsed time by the clock. False when the device is lost. */
bool stage_clock_wait(struct gl_renderer *renderer, uint64_t *stage);

#endif
