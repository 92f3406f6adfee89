#include "server/sandbox/job.h"

#include <string.h>

/* Byte offsets in a job's message: magic, kind, memory, answer, input, CPU, wall; zeros follow. */
enum {
    AT_MAGIC,
    AT_KIND = 4,
    AT_MEMORY = 8,
    AT_ANSWER = 16,
    AT_INPUT = 24,
    AT_CPU = 32,
    AT_WALL = 36
};
enum { AT_HOW, AT_VALUE = 4 };

#define JOB_MAGIC 0x6a6f6231u /* change it with the layout */

static void put32(uint8_t *at, uint32_t value)
{
    memcpy(at, &value, sizeof value);
}

static void put64(uint8_t *at, uint64_t value)
{
    memcpy(at, &value, sizeof value);
}

static uint32_t get32(const uint8_t *at)
{
    uint32_t value;
    memcpy(&value, at, sizeof value);
    return value;
}

static uint64_t get64(const uint8_t *at)
{
    uint64_t value;
    memcpy(&value, at, sizeof value);
    return value;
}

void job_encode(const struct job *job, uint8_t message[JOB_MESSAGE_BYTES])
{
    memset(message, 0, JOB_MESSAGE_BYTES);
    put32(message + AT_MAGIC, JOB_MAGIC);
    put32(message + AT_KIND, (uint32_t)job->kind);
    put64(message + AT_MEMORY, job->limits.memory_bytes);
    put64(message + AT_ANSWER, job->limits.answer_bytes);
    put64(message + AT_INPUT, job->input_bytes);
    put32(message + AT_CPU, job->limits.cpu_s);
    put32(message + AT_WALL, job->limits.wall_s);
}

bool job_decode(struct job *job, const uint8_t *message, size_t size)
{
    if (size != JOB_MESSAGE_BYTES || get32(message + AT_MAGIC) != JOB_MAGIC ||
        get32(message + AT_KIND) >= N_JOB_KINDS || get64(message + AT_INPUT) == 0)
        return false;
    *job = (struct job){
        .kind = (enum job_kind)get32(message + AT_KIND),
        .limits = {.memory_bytes = get64(message + AT_MEMORY),
                   .answer_bytes = get64(message + AT_ANSWER),
                   .cpu_s = get32(message + AT_CPU),
                   .wall_s = get32(message + AT_WALL)},
        .input_bytes = get64(message + AT_INPUT),
    };
    return true;
}

void job_end_encode(const struct job_end *end, uint8_t message[JOB_END_BYTES])
{
    put32(message + AT_HOW, (uint32_t)end->how);
    put32(message + AT_VALUE, end->value);
}

bool job_end_decode(struct job_end *end, const uint8_t *message, size_t size)
{
    if (size != JOB_END_BYTES || get32(message + AT_HOW) >= N_JOB_HOWS)
        return false;
    *end = (struct job_end){(enum job_how)get32(message + AT_HOW), get32(message + AT_VALUE)};
    return true;
}

void job_write_file(struct sink *input, const char *name, const void *bytes, size_t size)
{
    sink_text(input, name);
    sink_bytes(input, bytes, size);
}

const void *job_take_file(struct source *input, const char **name, size_t *size)
{
    *name = source_text(input);
    *size = input->left;
    return source_bytes(input, input->left);
}

void answer_write_ok(struct sink *sink)
{
    sink_u32(sink, ERROR_NONE);
}

void answer_write_error(struct sink *sink, const struct error *error)
{
    sink_u32(sink, (uint32_t)error->kind);
    sink_text(sink, error->text);
}

enum answer_status answer_read_status(struct source *source, struct error *error)
{
    uint32_t kind = source_u32(source);
    if (!source->ok)
        return ANSWER_BROKEN;
    if (kind == ERROR_NONE)
        return ANSWER_OK;
    const char *text = source_text(source);
    if ((kind != ERROR_REQUEST && kind != ERROR_MODEL && kind != ERROR_IMAGE &&
         kind != ERROR_SERVER) ||
        !source->ok || source->left > 0)
        return ANSWER_BROKEN;
    error_set(error, (enum error_kind)kind, "%s", text);
    return ANSWER_FAILED;
}
