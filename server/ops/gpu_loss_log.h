/* Counts how often the GPU was lost in the last ten minutes. After too many losses the daemon ends,
 * so that the service manager can start it again.
 * Thread: the loop's. */
#ifndef SHEEN_OPS_GPU_LOSS_LOG_H
#define SHEEN_OPS_GPU_LOSS_LOG_H

#include <stdbool.h>
#include <stdint.h>

#define GPU_LOSSES_MAX 64u              /* losses whose times are kept */
#define GPU_LOSSES_WINDOW_US 600000000u /* ten minutes */

/* Zero it before use. */
struct gpu_loss_log {
    uint64_t at_us[GPU_LOSSES_MAX]; /* times of the latest losses, by clock_now_us() */
    uint32_t n;                     /* losses since the start */
};

/* Records one loss. Returns true if at least `most` losses (1 to GPU_LOSSES_MAX) lie within the
 * window; never if `most` is 0. */
bool gpu_loss_log_add(struct gpu_loss_log *log, uint64_t now_us, uint64_t most);

#endif
