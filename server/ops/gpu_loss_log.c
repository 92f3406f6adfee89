#include "server/ops/gpu_loss_log.h"

bool gpu_loss_log_add(struct gpu_loss_log *log, uint64_t now_us, uint64_t most)
{
    log->at_us[log->n++ % GPU_LOSSES_MAX] = now_us;
    if (most == 0 || most > GPU_LOSSES_MAX || log->n < most)
        return false;
    uint64_t first_us = log->at_us[(log->n - most) % GPU_LOSSES_MAX];
    return now_us - first_us <= GPU_LOSSES_WINDOW_US;
}
