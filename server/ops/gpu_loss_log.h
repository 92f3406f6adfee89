/* How often the GPU has been lost lately: often enough, and the process had better start anew.
 * Thread: the loop's. */
#ifndef SHEEN_OPS_GPU_LOSS_LOG_H
#define SHEEN_OPS_GPU_LOSS_LOG_H

#include <stdbool.h>
#include <stdint.h>

#define LOSSES_MAX 64u              /* that can be told apart */
#define LOSSES_WINDOW_US 600000000u /* ten minutes */

/* Zero it before use. */
struct losses {
    uint64_t at_us[LOSSES_MAX]; /* loop_now_us(), of the last ones */
    uint32_t n;                 /* ever */
};

/* Takes one in. True when it is the `most`-th (up to LOSSES_MAX; 0: never) within the window. */
bool losses_add(struct losses *losses, uint64_t now_us, uint64_t most);

#endif
