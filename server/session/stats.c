#include "server/session/stats.h"

#include "server/base/clock.h"
#include "server/net/loop.h"

void stats_init(struct stats *stats)
{
    *stats = (struct stats){.start_us = clock_now_us()};
}

/* The current slice. A slice that held older figures is emptied first. */
static struct stats_slice *slice_now(struct stats *stats, uint64_t now_us)
{
    uint64_t number = (now_us - stats->start_us) / STATS_SLICE_US;
    struct stats_slice *slice = &stats->slices[number % STATS_SLICES];
    if (slice->number != number)
        *slice = (struct stats_slice){.number = number, .sent_before = stats->sent_bytes};
    return slice;
}

static const uint64_t *time_of(const sheen_Times *times, enum stats_stage stage)
{
    const uint64_t *const member[STAGE_COUNT] = {
        &times->tables_us,   &times->visibility_us, &times->evaluate_us, &times->shade_us,
        &times->readback_us, &times->encode_us,     &times->total_us,
    };
    return member[stage];
}

void stats_reply(struct stats *stats, uint8_t type, sheen_ErrorCode code, uint64_t now_us)
{
    stats->replies[type]++;
    stats->frames += type == MESSAGE_FRAME;
    stats->errors += type == MESSAGE_ERROR;
    if (type == MESSAGE_ERROR)
        stats->error_codes[code]++;
    struct stats_slice *slice = slice_now(stats, now_us);
    slice->requests++;
    slice->frames += type == MESSAGE_FRAME;
}

void stats_frame(struct stats *stats, enum request_class request_class, const sheen_Times *times,
                 uint64_t now_us)
{
    struct stats_slice *slice = slice_now(stats, now_us);
    for (unsigned stage = 0; stage < STAGE_COUNT; stage++) {
        uint64_t us = *time_of(times, stage);
        if (us == 0)
            continue;
        histogram_add(&stats->stage[stage], us);
        histogram_add(&slice->stage[stage], us);
    }
    histogram_add(&slice->latency[request_class], times->total_us);
    stats->last[stats->stage[STAGE_TOTAL].n % STATS_FRAMES] = *times;
}

sheen_Times stats_mean(const struct stats *stats)
{
    sheen_Times mean = sheen_Times_init_zero;
    uint64_t n = stats->stage[STAGE_TOTAL].n;
    n = n < STATS_FRAMES ? n : STATS_FRAMES;
    if (n == 0)
        return mean;
    for (uint64_t i = 0; i < STATS_FRAMES; i++) { /* unused places are zero */
        const sheen_Times *t = &stats->last[i];
        mean.tables_us += t->tables_us;
        mean.visibility_us += t->visibility_us;
        mean.evaluate_us += t->evaluate_us;
        mean.shade_us += t->shade_us;
        mean.readback_us += t->readback_us;
        mean.encode_us += t->encode_us;
        mean.total_us += t->total_us;
    }
    return (sheen_Times){mean.tables_us / n, mean.visibility_us / n, mean.evaluate_us / n,
                         mean.shade_us / n,  mean.readback_us / n,   mean.encode_us / n,
                         mean.total_us / n};
}

static void percentiles(const struct histogram stage[static STAGE_COUNT], double p,
                        sheen_Times *times)
{
    uint64_t *const member[STAGE_COUNT] = {
        &times->tables_us,   &times->visibility_us, &times->evaluate_us, &times->shade_us,
        &times->readback_us, &times->encode_us,     &times->total_us,
    };
    for (unsigned i = 0; i < STAGE_COUNT; i++)
        *member[i] = histogram_percentile(&stage[i], p);
}

static sheen_Latency latency_of(const struct histogram *histogram)
{
    return (sheen_Latency){.frames = histogram->n,
                           .p50_us = histogram_percentile(histogram, 0.5),
                           .p95_us = histogram_percentile(histogram, 0.95),
                           .p99_us = histogram_percentile(histogram, 0.99)};
}

void stats_recent(const struct stats *stats, uint64_t now_us, struct stats_recent *recent)
{
    struct histogram stage[STAGE_COUNT] = {{0}}, latency[N_CLASSES] = {{0}};
    uint64_t age = now_us - stats->start_us, number = age / STATS_SLICE_US;
    uint64_t first = number >= STATS_SLICES ? number - STATS_SLICES + 1 : 0;
    const struct stats_slice *oldest = NULL; /* the oldest slice that has a reply */
    *recent = (struct stats_recent){.window_us = age - first * STATS_SLICE_US};
    for (unsigned i = 0; i < STATS_SLICES; i++) {
        const struct stats_slice *slice = &stats->slices[i];
        if (slice->number < first)
            continue;
        if (slice->requests && (!oldest || slice->number < oldest->number))
            oldest = slice;
        recent->requests += slice->requests;
        recent->frames += slice->frames;
        for (unsigned k = 0; k < STAGE_COUNT; k++)
            histogram_merge(&stage[k], &slice->stage[k]);
        for (unsigned k = 0; k < N_CLASSES; k++)
            histogram_merge(&latency[k], &slice->latency[k]);
    }
    recent->sent_bytes = oldest ? stats->sent_bytes - oldest->sent_before : 0;
    for (unsigned k = 0; k < N_CLASSES; k++)
        recent->latency[k] = latency_of(&latency[k]);
    percentiles(stage, 0.5, &recent->p50);
    percentiles(stage, 0.95, &recent->p95);
    percentiles(stage, 0.99, &recent->p99);
}

const char *stats_stage_name(enum stats_stage stage)
{
    static const char *const NAMES[STAGE_COUNT] = {"tables",   "visibility", "evaluate", "shade",
                                                   "readback", "encode",     "total"};
    return NAMES[stage];
}

const char *stats_end_name(enum stats_end end)
{
    static const char *const NAMES[END_COUNT] = {
        "client", "lost", "protocol", "hello", "stalled", "unread", "idle", "drain", "credentials"};
    return NAMES[end];
}

const char *stats_error_name(sheen_ErrorCode code)
{
    switch (code) { /* no default, so that the compiler warns of a missing code */
    case sheen_ErrorCode_ERROR_NONE:
        break;
    case sheen_ErrorCode_ERROR_PROTOCOL:
        return "protocol";
    case sheen_ErrorCode_ERROR_VERSION:
        return "version";
    case sheen_ErrorCode_ERROR_REQUEST:
        return "request";
    case sheen_ErrorCode_ERROR_MODEL:
        return "model";
    case sheen_ErrorCode_ERROR_IMAGE:
        return "image";
    case sheen_ErrorCode_ERROR_UNKNOWN_MODEL:
        return "unknown_model";
    case sheen_ErrorCode_ERROR_TOO_BIG:
        return "too_big";
    case sheen_ErrorCode_ERROR_OVERLOADED:
        return "overloaded";
    case sheen_ErrorCode_ERROR_SHUTTING_DOWN:
        return "shutting_down";
    case sheen_ErrorCode_ERROR_DEVICE:
        return "device";
    case sheen_ErrorCode_ERROR_CANCELLED:
        return "cancelled";
    case sheen_ErrorCode_ERROR_DEADLINE:
        return "deadline";
    case sheen_ErrorCode_ERROR_GPU_LOST:
        return "gpu_lost";
    }
    return "none";
}
