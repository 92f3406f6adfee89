/* Counts how often the GPU has been lost lately. After too many losses the process should restart.
 * Thread: the loop's. */
#ifndef SHEEN_OPS_GPU_LOSS_LOG_H
#define SHEEN_OPS_GPU_LOSS_LOG_H

#include <stdbool.h>
#include <stdint.h>

#define GPU_LOSSES_MAX 64u              /* that can be told apart */
#define GPU_LOSSES_WINDOW_US 600000000u /* ten minutes */

/* Zero it before use. */
struct gpu_loss_log {
    uint64_t at_us[GPU_LOSSES_MAX]; /* clock_now_us(), of the last ones */
    uint32_t n;                     /* ever */
};

/* Records one loss. True when it is the `most`-th (up to GPU_LOSSES_MAX; 0: never) within the
 * window. */
bool gpu_loss_log_add(struct gpu_loss_log *log, uint64_t now_us, uint64_t most);

#endif
