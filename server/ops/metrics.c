#include "server/ops/metrics.h"

#include <dirent.h>
#include <inttypes.h>
#include <stdio.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/base/resident.h"
#include "server/base/log.h"
#include "server/base/quote.h"
#include "server/threads/pool.h"

/* Bounds of the exported buckets: powers of two of a microsecond, 64 us to 67 s. */
#define FIRST_EXPONENT 6u
#define LAST_EXPONENT 26u

static void head(struct text_buffer *text, const char *name, const char *type, const char *help)
{
    text_buffer_add(text, "# HELP sheen_%s %s\n# TYPE sheen_%s %s\n", name, help, name, type);
}

static void put(struct text_buffer *text, const char *name, const char *type, uint64_t value,
                const char *help)
{
    head(text, name, type, help);
    text_buffer_add(text, "sheen_%s %" PRIu64 "\n", name, value);
}

static void seconds(struct text_buffer *text, uint64_t us)
{
    text_buffer_add(text, "%" PRIu64 ".%06" PRIu64, us / 1000000, us % 1000000);
}

static void label(struct text_buffer *text, const char *name, const char *value)
{
    text_buffer_add(text, "%s=\"", name);
    while (*value) {
        char escaped[QUOTE_CHARACTER_BYTES];
        value += quote_character(QUOTE_METRICS, value, escaped);
        text_buffer_add(text, "%s", escaped);
    }
    text_buffer_add(text, "\"");
}

static void write_build(const struct daemon *daemon, struct text_buffer *text)
{
    const struct renderer_info *info = render_thread_info(daemon->render_thread);
    head(text, "build_info", "gauge", "Always 1; its labels say what runs.");
    text_buffer_add(text, "sheen_build_info{");
    label(text, "version", SHEEN_VERSION);
    text_buffer_add(text, ",");
    label(text, "device", info->device);
    text_buffer_add(text, ",");
    label(text, "driver", info->driver);
    text_buffer_add(text, ",software=\"%s\"} 1\n", info->software ? "true" : "false");
    put(text, "gpu_generation", "gauge", daemon->requests.gpu_generation,
        "1, and one more for each time that the GPU was lost.");
}

static void write_sessions(const struct daemon *daemon, struct text_buffer *text)
{
    const struct stats *stats = &daemon->sessions.stats;
    put(text, "sessions", "gauge", daemon->sessions.n_sessions, "Clients connected.");
    put(text, "sessions_opened_total", "counter", stats->sessions, "Sessions ever opened.");
    put(text, "sessions_refused_total", "counter", stats->refused,
        "Connections turned away before they were sessions.");
    head(text, "sessions_ended_total", "counter", "Sessions that have ended, by why.");
    for (unsigned i = 0; i < END_COUNT; i++)
        text_buffer_add(text, "sheen_sessions_ended_total{reason=\"%s\"} %" PRIu64 "\n",
                        stats_end_name(i), stats->ended[i]);
}

static void write_classes(const struct scheduler *scheduler, struct text_buffer *text)
{
    static const char *const NAMES[N_CLASSES] = {
        [CLASS_INTERACTIVE] = "interactive", [CLASS_STILL] = "still", [CLASS_BATCH] = "batch"};
    head(text, "frames_in_flight", "gauge", "Frames being rendered or encoded.");
    for (unsigned i = 0; i < N_CLASSES; i++)
        text_buffer_add(text, "sheen_frames_in_flight{class=\"%s\"} %u\n", NAMES[i],
                        scheduler->classes[i].begun);
    head(text, "gpu_seconds_total", "counter", "Time of the renderer, by class of request.");
    for (unsigned i = 0; i < N_CLASSES; i++) {
        text_buffer_add(text, "sheen_gpu_seconds_total{class=\"%s\"} ", NAMES[i]);
        seconds(text, scheduler->classes[i].spent_us);
        text_buffer_add(text, "\n");
    }
}

static void write_requests(const struct daemon *daemon, struct text_buffer *text)
{
    static const struct {
        uint8_t type;
        const char *name;
    } ANSWERS[] = {{MESSAGE_HELLO_OK, "hello"},   {MESSAGE_UPLOAD_STATE, "upload"},
                   {MESSAGE_MODEL_INFO, "model"}, {MESSAGE_FRAME, "frame"},
                   {MESSAGE_BREAKS, "breaks"},    {MESSAGE_COMPARED, "compared"},
                   {MESSAGE_CURVES, "curves"},    {MESSAGE_SUPERSEDED, "superseded"},
                   {MESSAGE_STATS, "stats"},      {MESSAGE_ERROR, "error"}};
    const struct stats *stats = &daemon->sessions.stats;
    head(text, "answers_total", "counter", "Answers, by what they are.");
    for (size_t i = 0; i < sizeof ANSWERS / sizeof *ANSWERS; i++)
        text_buffer_add(text, "sheen_answers_total{answer=\"%s\"} %" PRIu64 "\n", ANSWERS[i].name,
                        stats->replies[ANSWERS[i].type]);
    head(text, "errors_total", "counter", "Error answers, by their code.");
    for (unsigned i = sheen_ErrorCode_ERROR_PROTOCOL; i < _sheen_ErrorCode_ARRAYSIZE; i++)
        text_buffer_add(text, "sheen_errors_total{code=\"%s\"} %" PRIu64 "\n", stats_error_name(i),
                        stats->error_codes[i]);
    put(text, "queue_depth", "gauge", daemon->requests.scheduler.waiting,
        "Frames that wait for their turn.");
    write_classes(&daemon->requests.scheduler, text);
    put(text, "upload_bytes_total", "counter", stats->upload_bytes, "Bytes of files received.");
    put(text, "sent_bytes_total", "counter", stats->sent_bytes, "Bytes sent to clients.");
}

static void write_stage(const struct histogram *stage, const char *name, struct text_buffer *text)
{
    for (unsigned e = FIRST_EXPONENT; e <= LAST_EXPONENT; e++) {
        text_buffer_add(text, "sheen_frame_stage_seconds_bucket{stage=\"%s\",le=\"", name);
        seconds(text, 1ull << e);
        text_buffer_add(text, "\"} %" PRIu64 "\n", histogram_below(stage, e));
    }
    text_buffer_add(text,
                    "sheen_frame_stage_seconds_bucket{stage=\"%s\",le=\"+Inf\"} %" PRIu64
                    "\nsheen_frame_stage_seconds_count{stage=\"%s\"} %" PRIu64
                    "\nsheen_frame_stage_seconds_sum{stage=\"%s\"} ",
                    name, stage->n, name, stage->n, name);
    seconds(text, stage->sum_us);
    text_buffer_add(text, "\n");
}

static void write_stages(const struct daemon *daemon, struct text_buffer *text)
{
    head(text, "frame_stage_seconds", "histogram",
         "Time of each stage of a frame; a stage that a frame did without is not counted.");
    for (unsigned i = 0; i < STAGE_COUNT; i++)
        write_stage(&daemon->sessions.stats.stage[i], stats_stage_name(i), text);
}

static void write_store(const struct daemon *daemon, struct text_buffer *text)
{
    struct store_counts counts = store_count(daemon->store);
    put(text, "models", "gauge", counts.models, "Models ready to be rendered.");
    put(text, "images", "gauge", counts.images, "Light images ready to be used.");
    put(text, "model_cache_bytes", "gauge", counts.used_bytes,
        "Memory of files, tables, texels, messages and frames, on the GPU too.");
    put(text, "model_cache_limit_bytes", "gauge", counts.budget_bytes,
        "The most that they and the next three may take.");
    put(text, "device_bytes", "gauge", counts.device_bytes,
        "Memory that frames are drawn on, kept for later frames of the same view.");
    put(text, "spare_bytes", "gauge", counts.spare_bytes,
        "Memory of sent frames, kept for the next ones.");
    put(text, "daemon_bytes", "gauge", counts.daemon_bytes,
        "Memory of the budget that is set aside for the daemon itself.");
    put(text, "model_cache_hits_total", "counter", counts.hits,
        "Uses of a model or image that was ready.");
    put(text, "model_cache_misses_total", "counter", counts.misses,
        "Uses that had to wait for a build.");
    put(text, "model_cache_evictions_total", "counter", counts.evictions,
        "Models and images forgotten to make room.");
}

static uint64_t count_descriptors(void)
{
    uint64_t n = 0;
    DIR *folder = opendir("/proc/self/fd");
    if (!folder)
        return 0;
    for (const struct dirent *entry; (entry = readdir(folder));)
        n += entry->d_name[0] != '.';
    closedir(folder);
    return n - 1; /* without the descriptor that reads the folder */
}

static void write_process(const struct daemon *daemon, struct text_buffer *text)
{
    uint64_t now = clock_now_us();
    struct timespec cpu = {0};
    struct rlimit files = {0};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &cpu);
    getrlimit(RLIMIT_NOFILE, &files);
    head(text, "thread_busy_seconds", "gauge",
         "How long the GL thread, the compiler of shaders, or the longest at work of a pool has "
         "been at one piece.");
    text_buffer_add(text, "sheen_thread_busy_seconds{thread=\"gl\"} ");
    seconds(text, render_thread_busy_us(daemon->render_thread, now));
    text_buffer_add(text, "\nsheen_thread_busy_seconds{thread=\"compile\"} ");
    seconds(text, render_thread_compiling_us(daemon->render_thread, now));
    text_buffer_add(text, "\nsheen_thread_busy_seconds{thread=\"pool\"} ");
    seconds(text, pool_busy_us(daemon->pool, now));
    text_buffer_add(text, "\nsheen_thread_busy_seconds{thread=\"read\"} ");
    seconds(text, pool_busy_us(daemon->readers, now));
    text_buffer_add(text, "\n");
    put(text, "log_lines_left_out_total", "counter", log_left_out(),
        "Log lines above the most a second.");
    /* Names that all Prometheus clients use for these figures. */
    text_buffer_add(
        text,
        "# HELP process_start_time_seconds Unix time of the start.\n"
        "# TYPE process_start_time_seconds gauge\nprocess_start_time_seconds %lld\n"
        "# HELP process_cpu_seconds_total Processor time, all threads.\n"
        "# TYPE process_cpu_seconds_total counter\nprocess_cpu_seconds_total %lld.%06ld\n"
        "# HELP process_resident_memory_bytes Memory in use.\n"
        "# TYPE process_resident_memory_bytes gauge\nprocess_resident_memory_bytes %" PRIu64
        "\n# HELP process_open_fds Open descriptors.\n"
        "# TYPE process_open_fds gauge\nprocess_open_fds %" PRIu64
        "\n# HELP process_max_fds The most there may be.\n"
        "# TYPE process_max_fds gauge\nprocess_max_fds %llu\n",
        (long long)time(NULL) - (long long)((now - daemon->sessions.stats.start_us) / 1000000),
        (long long)cpu.tv_sec, cpu.tv_nsec / 1000, resident_bytes(), count_descriptors(),
        (unsigned long long)files.rlim_cur);
}

void metrics_write(const struct daemon *daemon, struct text_buffer *text)
{
    write_build(daemon, text);
    write_sessions(daemon, text);
    write_requests(daemon, text);
    write_stages(daemon, text);
    write_store(daemon, text);
    write_process(daemon, text);
}
