#include "client/cli/stream/report.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "client/cli/options/lights_text.h"
#include "client/cli/options/values.h"

static const char *const STAGE_NAMES[N_STAGES] = {
    "tables", "visibility", "evaluate", "shade", "readback", "encode", "total", "round_trip"};

void stream_keep_drawn(struct stream *stream, uint32_t n_frames)
{
    uint32_t n_kept = 0;
    for (uint32_t i = 0; i < n_frames; i++)
        if (stream->records[i].state == DRAWN)
            stream->records[n_kept++] = stream->records[i];
}

static double frames_per_second(const struct stream *stream, uint32_t n_frames)
{
    if (n_frames < 2)
        return 1e6 / (double)stream->records[0].stage_us[ROUND_TRIP];
    return (n_frames - 1) * 1e6 / (double)stream->elapsed_us;
}

static int compare_us(const void *a, const void *b)
{
    uint64_t left = *(const uint64_t *)a, right = *(const uint64_t *)b;
    return left < right ? -1 : left > right;
}

void stream_print_table(const struct stream *stream, uint32_t n_frames, uint64_t *sorted,
                        const struct options *options)
{
    const struct sheen_frame *frame = &stream->frame;
    printf("%u %s, %ux%u, %s\n", n_frames, value_noun(n_frames, "frame", "frames"), frame->width_px,
           frame->height_px, frame->device);
    printf("%-12s %10s %10s %10s   ms\n", "stage", "min", "median", "p95");
    for (int stage = 0; stage < N_STAGES; stage++) {
        for (uint32_t i = 0; i < n_frames; i++)
            sorted[i] = stream->records[i].stage_us[stage];
        qsort(sorted, n_frames, sizeof(*sorted), compare_us);
        uint32_t p95 = (uint32_t)(((uint64_t)n_frames * 95 + 99) / 100) - 1; /* nearest rank */
        printf("%-12s %10.2f %10.2f %10.2f\n", STAGE_NAMES[stage], (double)sorted[0] / 1e3,
               (double)sorted[(n_frames - 1) / 2] / 1e3, (double)sorted[p95] / 1e3);
    }
    printf("%.1f frames per second%s\n", frames_per_second(stream, n_frames),
           n_frames > 1 ? ", the first left out" : "");
    if (stream->request.show.range > 0)
        printf("colours of %s end at %.6g either way, in all frames\n",
               text_show_kind(stream->request.show.kind), stream->request.show.range);
    if (stream->n_late > 0)
        printf("%u more %s late\n", stream->n_late, value_noun(stream->n_late, "was", "were"));
    if (options->output)
        printf("%s: %u %s, %" PRIu64 " bytes\n", options->output, n_frames,
               value_noun(n_frames, "file", "files"), stream->written_bytes);
}

static void json_file(struct json *json, const struct options *options, uint32_t number)
{
    char *path = options->output ? frame_names_path(&options->frame_names, number) : NULL;
    if (path)
        json_text(json, "file", path);
    free(path);
}

void stream_print_json(struct json *json, const struct stream *stream, uint32_t n_frames,
                       const struct client *client, const struct options *options)
{
    const struct sheen_frame *frame = &stream->frame;
    json_object_begin(json, NULL);
    json_uint(json, "width", frame->width_px);
    json_uint(json, "height", frame->height_px);
    client_json_origin(json, client, options, frame);
    json_double(json, "frames_per_second", frames_per_second(stream, n_frames));
    json_uint(json, "late", stream->n_late);
    if (options->output) {
        json_text(json, "output", options->output);
        json_uint(json, "written", n_frames);
        json_uint(json, "written_bytes", stream->written_bytes);
    }
    client_json_schedule(json, &stream->request);
    if (stream->request.show.kind != SHEEN_SHOW_LINES)
        json_text(json, "show", text_show_kind(stream->request.show.kind));
    if (stream->request.show.range > 0)
        json_double(json, "show_range", stream->request.show.range);
    json_array_begin(json, "frames");
    for (uint32_t i = 0; i < n_frames; i++) {
        json_object_begin(json, NULL);
        json_uint(json, "number", stream->records[i].number);
        json_file(json, options, stream->records[i].number);
        for (int stage = 0; stage < N_STAGES; stage++) {
            char key[24];
            snprintf(key, sizeof(key), "%s_us", STAGE_NAMES[stage]);
            json_uint(json, key, stream->records[i].stage_us[stage]);
        }
        json_uint(json, "data_bytes", stream->records[i].data_bytes);
        json_object_end(json);
    }
    json_array_end(json);
    json_lines(json, "warnings", stream->info.warnings);
    json_object_end(json);
}
