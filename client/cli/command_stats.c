/* sheen stats: what the daemon is doing. */
#include <inttypes.h>
#include <stdio.h>

#include "client/cli/commands.h"
#include "client/cli/client.h"
#include "client/cli/options/values.h"

/* The time over which rates are computed: at least one second, because the single request of a
 * daemon that has just started would look like a thousand per second. */
static double window_s(const struct sheen_stats *stats)
{
    return stats->window_us < 1000000 ? 1 : (double)stats->window_us / 1e6;
}

static double per_second(const struct sheen_stats *stats, uint64_t n)
{
    return (double)n / window_s(stats);
}

static void json_times(struct json *json, const char *key, const struct sheen_times *times)
{
    json_object_begin(json, key);
    client_json_times(json, times);
    json_object_end(json);
}

static void json_latency(struct json *json, const char *key, const struct sheen_latency *latency)
{
    json_object_begin(json, key);
    json_uint(json, "frames", latency->frames);
    json_uint(json, "p50_us", latency->p50_us);
    json_uint(json, "p95_us", latency->p95_us);
    json_uint(json, "p99_us", latency->p99_us);
    json_object_end(json);
}

static void print_json(struct json *json, const struct sheen_stats *stats)
{
    json_object_begin(json, NULL);
    json_text(json, "server", stats->server);
    json_text(json, "device", stats->device);
    json_text(json, "driver", stats->driver);
    json_bool(json, "software", stats->software);
    json_uint(json, "threads", stats->threads);
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
    json_object_begin(json, "budget");
    json_uint(json, "bytes", stats->budget_bytes);
    json_uint(json, "assets", stats->assets_bytes);
    json_uint(json, "input", stats->input_bytes);
    json_uint(json, "interactive", stats->interactive_bytes);
    json_uint(json, "patient", stats->patient_bytes);
    json_uint(json, "device", stats->device_bytes);
    json_uint(json, "spare", stats->spare_bytes);
    json_uint(json, "daemon", stats->daemon_bytes);
    json_object_end(json);
    json_uint(json, "models", stats->models);
    json_uint(json, "model_bytes", stats->model_bytes);
    json_uint(json, "images", stats->images);
    json_uint(json, "uploads_bytes", stats->uploads_bytes);
    json_uint(json, "sent_bytes", stats->sent_bytes);
    json_times(json, "mean", &stats->mean);
    json_uint(json, "window_us", stats->window_us);
    json_double(json, "requests_per_s", per_second(stats, stats->window_requests));
    json_double(json, "frames_per_s", per_second(stats, stats->window_frames));
    json_double(json, "sent_bytes_per_s", per_second(stats, stats->window_sent_bytes));
    json_object_begin(json, "latency");
    json_latency(json, "interactive", &stats->interactive);
    json_latency(json, "still", &stats->still);
    json_latency(json, "batch", &stats->batch);
    json_object_end(json);
    json_times(json, "p50", &stats->p50);
    json_times(json, "p95", &stats->p95);
    json_times(json, "p99", &stats->p99);
    json_object_end(json);
}

static void print_times(const char *name, const struct sheen_times *times)
{
    const uint64_t us[] = {times->tables_us, times->visibility_us, times->evaluate_us,
                           times->shade_us,  times->readback_us,   times->encode_us,
                           times->total_us};
    printf("%-10s", name);
    for (size_t i = 0; i < sizeof(us) / sizeof(*us); i++)
        printf(" %10.2f", (double)us[i] / 1e3);
    putchar('\n');
}

static void print_latency(const char *name, const struct sheen_stats *stats,
                          const struct sheen_latency *latency)
{
    printf("%-12s %10" PRIu64 " %10.1f %10.2f %10.2f %10.2f\n", name, latency->frames,
           per_second(stats, latency->frames), (double)latency->p50_us / 1e3,
           (double)latency->p95_us / 1e3, (double)latency->p99_us / 1e3);
}

/* What holds the budget, in MB; an older daemon does not tell. */
static void print_budget(const struct sheen_stats *of)
{
    const double mb = 1.0 / (1 << 20);
    if (of->budget_bytes)
        printf("%-10s of %.0f MB, MB: models and images %.1f, receiving %.1f, interactive frames "
               "%.1f,\n%-10s others %.1f, drawing %.1f, spare %.1f, daemon %.1f\n",
               "budget", mb * of->budget_bytes, mb * of->assets_bytes, mb * of->input_bytes,
               mb * of->interactive_bytes, "", mb * of->patient_bytes, mb * of->device_bytes,
               mb * of->spare_bytes, mb * of->daemon_bytes);
}

static void print_table(const struct sheen_stats *stats)
{
    printf("%-10s sheend %s, up %.0f s\n", "server", stats->server, (double)stats->uptime_us / 1e6);
    printf("%-10s %s (%s)%s", "device", stats->device, stats->driver,
           stats->software ? ", software" : "");
    if (stats->threads)
        printf(", %u %s", stats->threads, value_noun(stats->threads, "thread", "threads"));
    putchar('\n');
    printf("%-10s %u, %u requests queued\n", "sessions", stats->sessions, stats->queued);
    printf("%-10s %" PRIu64 " sent, %" PRIu64 " errors\n", "frames", stats->frames, stats->errors);
    printf("%-10s %" PRIu64 " superseded, %" PRIu64 " cancelled, %" PRIu64 " late; %" PRIu64
           " clients disconnected\n",
           "", stats->superseded, stats->cancelled, stats->late, stats->disconnected);
    printf("%-10s device time spent, s: interactive %.1f, still %.1f, batch %.1f\n", "renderer",
           (double)stats->interactive_us / 1e6, (double)stats->still_us / 1e6,
           (double)stats->batch_us / 1e6);
    printf("%-10s %" PRIu64 " bytes in use, of --memory-budget\n", "memory", stats->memory_bytes);
    print_budget(stats);
    printf("%-10s %u, %" PRIu64 " bytes of tables %s; %u images\n", "models", stats->models,
           stats->model_bytes, client_place_of_tables(stats->software), stats->images);
    printf("%-10s %" PRIu64 " bytes uploaded, %" PRIu64 " bytes sent\n", "traffic",
           stats->uploads_bytes, stats->sent_bytes);
    printf("%-10s %.1f requests/s, %.1f frames/s, %.0f bytes/s over the last %.0f s\n", "rates",
           per_second(stats, stats->window_requests), per_second(stats, stats->window_frames),
           per_second(stats, stats->window_sent_bytes), window_s(stats));
    printf("%-12s %10s %10s %10s %10s %10s\n", "ms of class", "frames", "frames/s", "p50", "p95",
           "p99");
    print_latency("interactive", stats, &stats->interactive);
    print_latency("still", stats, &stats->still);
    print_latency("batch", stats, &stats->batch);
    printf("%-10s %10s %10s %10s %10s %10s %10s %10s\n", "ms a frame", "tables", "visibility",
           "evaluate", "shade", "readback", "encode", "total");
    print_times("mean", &stats->mean);
    print_times("p50", &stats->p50);
    print_times("p95", &stats->p95);
    print_times("p99", &stats->p99);
    puts("mean: of the last 64 frames, 0 for a stage that a frame did not need; p50, p95, p99: of\n"
         "the last minute's frames that needed the stage");
}

/* stats asks one particular daemon: the numbers of another are no answer. */
static bool check(struct options *options, char *why)
{
    (void)why;
    options->reconnect_s = 0;
    return true;
}

static int run(const struct options *options)
{
    struct client client;
    struct sheen_stats stats = SHEEN_STATS_DEFAULTS;
    enum sheen_status status = client_init(&client, options);
    if (!status)
        status = sheen_query_stats(client.session, &stats, &client.error);
    if (!status && options->json) {
        struct json json = {.out = stdout};
        print_json(&json, &stats);
        status = client_finish_json(&client, &json);
    } else if (!status) {
        print_table(&stats);
    }
    return client_finish(&client, status);
}

static const struct option_row *const TABLES[] = {OPTIONS_COMMON, OPTIONS_OUTPUT, NULL};

const struct command COMMAND_STATS = {
    .name = "stats",
    .arguments = "[option]...",
    .summary =
        "Prints a daemon's statistics. For the last minute: rates, percentiles of the time of "
        "each\n"
        "stage, and for each class those of the time from a request's last byte to the answer's\n"
        "first; also the mean of the last 64 frames. Without a server it describes a new private\n"
        "daemon, that is the device of this machine. If the daemon ends meanwhile, the command\n"
        "fails: a daemon that takes its place has different numbers.",
    .tables = TABLES,
    .examples = "  sheen stats --server unix:/run/sheen/sheen.sock\n"
                "  sheen stats --json\n",
    .check = check,
    .codes = CODE_OUTPUT | CODE_SERVER,
    .run = run,
};
