#include <string.h>

#include "client/lib/session.h"
#include "client/lib/sized.h"
#include "client/lib/status.h"
#include "client/lib/times.h"

static struct sheen_latency latency_from_message(const sheen_Latency *latency)
{
    return (struct sheen_latency){latency->frames, latency->p50_us, latency->p95_us,
                                  latency->p99_us};
}

enum sheen_status sheen_query_stats(struct sheen_session *session, struct sheen_stats *stats,
                                    struct sheen_error *error)
{
    uint32_t seq;
    sheen_Stats body;
    enum sheen_status status = session_check(session, error);
    if (status)
        return status;
    status = sized_check(stats, "stats", error);
    if (status)
        return status;
    if (session->n_pending)
        return status_set(error, SHEEN_BAD_ARGUMENT,
                          "a statistics query needs that no request is in flight");
    status = session_send(session, MESSAGE_STATS_QUERY, NULL, &seq, error);
    if (!status)
        status = session_receive(session, seq, MESSAGE_STATS, NULL, &body, error);
    if (status)
        return status;
    struct sheen_stats whole = {
        .uptime_us = body.uptime_us,
        .sessions = body.sessions,
        .queued = body.queued,
        .frames = body.frames,
        .errors = body.errors,
        .models = body.models,
        .images = body.images,
        .model_bytes = body.model_bytes,
        .uploads_bytes = body.uploads_bytes,
        .sent_bytes = body.sent_bytes,
        .superseded = body.superseded,
        .cancelled = body.cancelled,
        .late = body.late,
        .disconnected = body.disconnected,
        .interactive_us = body.interactive_us,
        .still_us = body.still_us,
        .batch_us = body.batch_us,
        .memory_bytes = body.memory_bytes,
        .mean = times_from_message(&body.mean),
        .window_us = body.window_us,
        .window_requests = body.window_requests,
        .window_frames = body.window_frames,
        .window_sent_bytes = body.window_sent_bytes,
        .interactive = latency_from_message(&body.interactive),
        .still = latency_from_message(&body.still),
        .batch = latency_from_message(&body.batch),
        .p50 = times_from_message(&body.p50),
        .p95 = times_from_message(&body.p95),
        .p99 = times_from_message(&body.p99),
        .software = body.software,
        .threads = body.threads,
        .budget_bytes = body.budget_bytes,
        .assets_bytes = body.assets_bytes,
        .input_bytes = body.input_bytes,
        .interactive_bytes = body.interactive_bytes,
        .patient_bytes = body.patient_bytes,
        .device_bytes = body.device_bytes,
        .spare_bytes = body.spare_bytes,
        .daemon_bytes = body.daemon_bytes,
    };
    memcpy(whole.device, body.device, sizeof(whole.device));
    memcpy(whole.driver, body.driver, sizeof(whole.driver));
    memcpy(whole.server, body.server, sizeof(whole.server));
    sized_give(stats, &whole, sizeof(whole));
    return SHEEN_OK;
}
