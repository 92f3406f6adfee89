/* sheen stats: what the daemon is doing. */
#include <inttypes.h>
#include <stdio.h>

#include "client/commands.h"
#include "client/job.h"

static void print_json(struct json *json, const struct sheen_stats *stats)
{
    json_object_begin(json, NULL);
    json_string(json, "server", stats->server);
    json_string(json, "device", stats->device);
    json_string(json, "driver", stats->driver);
    json_bool(json, "software", stats->software);
    json_uint(json, "uptime_us", stats->uptime_us);
    json_uint(json, "sessions", stats->sessions);
    json_uint(json, "queued", stats->queued);
    json_uint(json, "frames", stats->frames);
    json_uint(json, "errors", stats->errors);
    json_uint(json, "superseded", stats->superseded);
    json_uint(json, "cancelled", stats->cancelled);
    json_uint(json, "late", stats->late);
    json_uint(json, "disconnected", stats->disconnected);
    json_uint(json, "interactive_us", stats->interactive_us);
    json_uint(json, "still_us", stats->still_us);
    json_uint(json, "batch_us", stats->batch_us);
    json_uint(json, "memory_bytes", stats->memory_bytes);
    json_uint(json, "models", stats->models);
    json_uint(json, "model_bytes", stats->model_bytes);
    json_uint(json, "images", stats->images);
    json_uint(json, "uploads_bytes", stats->uploads_bytes);
    json_uint(json, "sent_bytes", stats->sent_bytes);
    json_object_begin(json, "mean");
    job_json_times(json, &stats->mean);
    json_object_end(json);
    json_object_end(json);
}

static void print_table(const struct sheen_stats *stats)
{
    printf("%-10s sheend %s, up %.0f s\n", "server", stats->server, (double)stats->uptime_us / 1e6);
    printf("%-10s %s (%s)%s\n", "device", stats->device, stats->driver,
           stats->software ? ", software" : "");
    printf("%-10s %u, %u requests queued\n", "sessions", stats->sessions, stats->queued);
    printf("%-10s %" PRIu64 " sent, %" PRIu64 " errors\n", "frames", stats->frames, stats->errors);
    printf("%-10s %" PRIu64 " superseded, %" PRIu64 " cancelled, %" PRIu64 " late; %" PRIu64
           " clients disconnected\n",
           "", stats->superseded, stats->cancelled, stats->late, stats->disconnected);
    printf("%-10s interactive %.1f, still %.1f, batch %.1f s\n", "renderer",
           (double)stats->interactive_us / 1e6, (double)stats->still_us / 1e6,
           (double)stats->batch_us / 1e6);
    printf("%-10s %" PRIu64 " bytes of the budget in use\n", "memory", stats->memory_bytes);
    printf("%-10s %u, %" PRIu64 " bytes on the GPU; %u images\n", "models", stats->models,
           stats->model_bytes, stats->images);
    printf("%-10s %" PRIu64 " bytes in, %" PRIu64 " bytes out\n", "traffic", stats->uploads_bytes,
           stats->sent_bytes);
    printf("%-10s tables %.2f, visibility %.2f, evaluate %.2f, shade %.2f, readback %.2f, "
           "encode %.2f, total %.2f ms\n",
           "mean", (double)stats->mean.tables_us / 1e3, (double)stats->mean.visibility_us / 1e3,
           (double)stats->mean.evaluate_us / 1e3, (double)stats->mean.shade_us / 1e3,
           (double)stats->mean.readback_us / 1e3, (double)stats->mean.encode_us / 1e3,
           (double)stats->mean.total_us / 1e3);
}

static int run(const struct options *options)
{
    struct job job;
    struct sheen_stats stats;
    enum sheen_status status = job_init(&job, options);
    if (!status)
        status = sheen_query_stats(job.session, &stats, &job.error);
    if (!status && options->json) {
        struct json json = {.out = stdout};
        print_json(&json, &stats);
        status = job_finish_json(&job, &json);
    } else if (!status) {
        print_table(&stats);
    }
    return job_finish(&job, status);
}

static const struct option_row *const TABLES[] = {OPTIONS_COMMON, OPTIONS_OUTPUT, NULL};

const struct command COMMAND_STATS = {
    .name = "stats",
    .arguments = "[option]...",
    .summary = "Says what a daemon is doing. Without a server it tells of a fresh private daemon:\n"
               "the device that this machine has.",
    .tables = TABLES,
    .examples = "  sheen stats --server unix:/run/sheen.sock\n"
                "  sheen stats --json\n",
    .run = run,
};
