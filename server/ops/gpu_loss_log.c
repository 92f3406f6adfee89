#include "server/ops/gpu_loss_log.h"

bool losses_add(struct losses *losses, uint64_t now_us, uint64_t most)
{
    losses->at_us[losses->n++ % LOSSES_MAX] = now_us;
    if (most == 0 || most > LOSSES_MAX || losses->n < most)
        return false;
    uint64_t first_us = losses->at_us[(losses->n - most) % LOSSES_MAX];
    return now_us - first_us <= LOSSES_WINDOW_US;
}
