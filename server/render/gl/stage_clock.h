/* What the stages of a tile took: by timer queries on the device, so that it never stands still
 * between them, or by the clock, waiting for each. GL thread. */
#ifndef SHEEN_RENDER_GL_STAGE_CLOCK_H
#define SHEEN_RENDER_GL_STAGE_CLOCK_H

#include <epoxy/gl.h>

#include <stdbool.h>
#include <stdint.h>

struct gl_renderer;

/* Has the device timer queries that hold all of its work? */
bool stage_clock_by_device(const struct gl_renderer *renderer);
void stage_clock_init(struct gl_renderer *renderer);
/* A tile begins: by the clock, the processor's time from here on counts for the tile's first stage.
 */
void stage_clock_begin(struct gl_renderer *renderer);
/* To be called before and after the commands of a stage. The stage's time is added to *stage: at
 * once, by the clock, after waiting for the device; or by device queries in stage_clock_read(), and
 * then the pointer must stay until that. False when the device is lost. */
void stage_clock_start(struct gl_renderer *renderer);
bool stage_clock_end(struct gl_renderer *renderer, uint64_t *stage);
/* Waits for the stages that have ended, where that has not been done, and adds their times. False
 * when the device is lost. */
bool stage_clock_read(struct gl_renderer *renderer);
/* Waits for the device and adds what has passed by the clock. False when it is lost. */
bool stage_clock_wait(struct gl_renderer *renderer, uint64_t *stage);

#endif
