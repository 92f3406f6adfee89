/* Statistics of a daemon. sheen.h has the rules. */
#ifndef SHEEN_PUBLIC_STATS_H
#define SHEEN_PUBLIC_STATS_H

#include "base.h"
#include "frame.h"
#include "session.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

SHEEN_DECLARATIONS_BEGIN

/* Latency of one class's frames in the last minute, from the request's last byte to the answer's
 * first, exact to 3 %; zeros if there were none. */
struct sheen_latency {
    uint64_t frames, p50_us, p95_us, p99_us;
};

struct sheen_stats {
    size_t size;
    uint64_t uptime_us;
    uint32_t sessions, queued; /* now */
    uint64_t frames, errors;   /* since the start */
    uint32_t models, images;   /* in the daemon's memory now */
    /* Bytes of the models' tables, in the memory in which sheen_model_info.table_bytes are counted:
     * of the device, or main memory where processors draw. */
    uint64_t model_bytes;
    uint64_t uploads_bytes, sent_bytes;   /* sums since the start */
    uint64_t superseded, cancelled, late; /* requests with this answer since the start */
    /* Clients disconnected for exceeding a limit or breaking the protocol. */
    uint64_t disconnected;
    uint64_t interactive_us, still_us, batch_us; /* time of the renderer, by class */
    uint64_t memory_bytes;                       /* memory in use now, of the budget */
    struct sheen_times mean;                     /* mean of the last 64 frames */
    /* The last minute, or less soon after the start; window_us is 0 if the daemon is too old to
     * tell. Percentiles are computed for each stage separately, exact to 3 %; 0: no frame needed
     * the stage. */
    uint64_t window_us, window_requests, window_frames;
    uint64_t window_sent_bytes; /* since the first answer in the window */
    struct sheen_latency interactive, still, batch;
    struct sheen_times p50, p95, p99;
    char device[128], driver[128], server[32];
    bool software;
    uint32_t threads; /* threads that draw without a GPU; 0: a GPU, or unknown */
    /* The daemon's memory budget, and what holds it: models and images; what is being received;
     * frames, and computations, by class; what frames are drawn on; memory kept for the next
     * frames; what is set aside for the daemon itself. All 0 if the daemon is too old to tell. */
    uint64_t budget_bytes;
    uint64_t assets_bytes, input_bytes, interactive_bytes, patient_bytes;
    uint64_t device_bytes, spare_bytes, daemon_bytes;
};
#define SHEEN_STATS_DEFAULTS ((struct sheen_stats){.size = sizeof(struct sheen_stats)})

/* Asks for the daemon's statistics. SHEEN_BAD_ARGUMENT while requests are in flight. */
enum sheen_status sheen_query_stats(struct sheen_session *session, struct sheen_stats *stats,
                                    struct sheen_error *error);

static inline struct sheen_stats sheen_stats_defaults(void)
{
    struct sheen_stats stats;
    sheen_struct_init(&stats, sizeof(stats));
    return stats;
}

SHEEN_DECLARATIONS_END

#endif
