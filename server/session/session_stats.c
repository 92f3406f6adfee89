#include <stdio.h>

#include "server/base/clock.h"
#include "server/session/session_internal.h"

/* Adds the rates of the last minute, and percentiles for each stage and each class. */
static void add_recent(sheen_Stats *body, const struct stats *stats)
{
    struct stats_recent recent;
    stats_recent(stats, clock_now_us(), &recent);
    body->has_window_us = body->has_window_requests = body->has_window_frames = true;
    body->window_us = recent.window_us;
    body->window_requests = recent.requests;
    body->window_frames = recent.frames;
    body->has_p50 = body->has_p95 = body->has_p99 = true;
    body->p50 = recent.p50;
    body->p95 = recent.p95;
    body->p99 = recent.p99;
    body->has_window_sent_bytes = true;
    body->window_sent_bytes = recent.sent_bytes;
    body->has_interactive = body->has_still = body->has_batch = true;
    body->interactive = recent.latency[CLASS_INTERACTIVE];
    body->still = recent.latency[CLASS_STILL];
    body->batch = recent.latency[CLASS_BATCH];
}

/* Adds what holds the memory budget. */
static void add_budget(sheen_Stats *body, const struct store_counts *counts)
{
    body->has_budget_bytes = body->has_assets_bytes = body->has_input_bytes = true;
    body->has_interactive_bytes = body->has_patient_bytes = body->has_device_bytes = true;
    body->has_spare_bytes = body->has_daemon_bytes = true;
    body->budget_bytes = counts->budget_bytes;
    body->assets_bytes = counts->assets_bytes;
    body->input_bytes = counts->input_bytes;
    body->interactive_bytes = counts->interactive_bytes;
    body->patient_bytes = counts->patient_bytes;
    body->device_bytes = counts->device_bytes;
    body->spare_bytes = counts->spare_bytes;
    body->daemon_bytes = counts->daemon_bytes;
}

void session_reply_stats(struct session *session, uint32_t seq)
{
    const struct session_host *host = session->host;
    const struct renderer_info *info = render_thread_info(host->render_thread);
    const struct scheduler *scheduler = &host->requests->scheduler;
    struct store_counts counts = store_count(host->store);
    sheen_Stats stats = {
        .uptime_us = clock_now_us() - host->stats.start_us,
        .sessions = host->n_sessions,
        .frames = host->stats.frames,
        .errors = host->stats.errors,
        .models = counts.models,
        .model_bytes = counts.model_bytes,
        .images = counts.images,
        .uploads_bytes = host->stats.upload_bytes,
        .sent_bytes = host->stats.sent_bytes,
        .software = info->software,
        .has_threads = info->n_threads > 0,
        .threads = info->n_threads,
        .mean = stats_mean(&host->stats),
        .queued = scheduler->waiting,
        .has_superseded = true,
        .superseded = host->stats.replies[MESSAGE_SUPERSEDED],
        .has_cancelled = true,
        .cancelled = host->stats.error_codes[sheen_ErrorCode_ERROR_CANCELLED],
        .has_late = true,
        .late = host->stats.error_codes[sheen_ErrorCode_ERROR_DEADLINE],
        .has_disconnected = true,
        .disconnected = host->stats.disconnected,
        .has_interactive_us = true,
        .interactive_us = scheduler->classes[CLASS_INTERACTIVE].spent_us,
        .has_still_us = true,
        .still_us = scheduler->classes[CLASS_STILL].spent_us,
        .has_batch_us = true,
        .batch_us = scheduler->classes[CLASS_BATCH].spent_us,
        .has_memory_bytes = true,
        .memory_bytes = counts.used_bytes,
    };
    add_recent(&stats, &host->stats);
    add_budget(&stats, &counts);
    snprintf(stats.device, sizeof stats.device, "%s", info->device);
    snprintf(stats.driver, sizeof stats.driver, "%s", info->driver);
    snprintf(stats.server, sizeof stats.server, "%s", SHEEN_VERSION);
    session_reply_now(session, seq, MESSAGE_STATS, &stats);
}
