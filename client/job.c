#include "client/job.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "client/file.h"
#include "client/status.h"
#include "client/values.h"

#define TOKEN_BYTES 256
#define FIRST_RESUME_MS 200u
#define AT_SERVER "server:" /* a MODEL that is a file below the daemon's --models */

static enum sheen_status upload(struct job *job, enum sheen_file_kind kind, const char *path,
                                const uint8_t *bytes, size_t n_bytes,
                                const uint8_t id[SHEEN_ID_BYTES])
{
    return sheen_upload(job->session, kind, id, bytes, n_bytes, path, &job->report, &job->error);
}

static enum sheen_status identify(struct job *job, const uint8_t *bytes, size_t n_bytes,
                                  uint8_t id[SHEEN_ID_BYTES])
{
    if (sheen_file_id(bytes, n_bytes, id))
        return SHEEN_OK;
    return status_set(&job->error, SHEEN_NO_MEMORY, "libcrypto cannot compute a SHA-256");
}

static enum sheen_status connect_and_upload(struct job *job, const struct options *options)
{
    uint8_t *bytes = NULL;
    size_t n_bytes = 0;
    struct sheen_connect_options connect = SHEEN_CONNECT_DEFAULTS;
    connect.address = options->server;
    connect.device = options->device;
    connect.ca = options->ca;
    connect.cert = options->cert;
    connect.key = options->key;
    connect.share = options->share;
    char token[TOKEN_BYTES];
    enum sheen_status status = SHEEN_OK;
    if (options->token_file) {
        status = file_read_line(options->token_file, token, sizeof(token), &job->error);
        connect.token = token;
    }
    const char *at_server =
        options->model && strncmp(options->model, AT_SERVER, strlen(AT_SERVER)) == 0
            ? options->model + strlen(AT_SERVER)
            : NULL;
    bool local = options->model && !at_server;
    if (!status && local) {
        status = file_read(options->model, SHEEN_BAD_MODEL, &bytes, &n_bytes, &job->error);
        if (!status)
            status = identify(job, bytes, n_bytes, job->model_id);
        memcpy(connect.model_id, job->model_id, SHEEN_ID_BYTES);
    }
    if (!status)
        status = sheen_connect(&job->session, &connect, &job->error);
    if (!status && at_server)
        status =
            sheen_find_model(job->session, at_server, &job->report, job->model_id, &job->error);
    if (!status && local)
        status = upload(job, SHEEN_FILE_MODEL, options->model, bytes, n_bytes, job->model_id);
    free(bytes);
    return status;
}

enum sheen_status job_init(struct job *job, const struct options *options)
{
    *job = (struct job){0};
    job->report = progress_init(&job->progress, options->quiet);
    return connect_and_upload(job, options);
}

bool job_resume(struct job *job, const struct options *options, enum sheen_status *status)
{
    if (!options->server || *status != SHEEN_SHUTTING_DOWN)
        return false;
    while (job->n_resumes < JOB_MAX_RESUMES &&
           (*status == SHEEN_SHUTTING_DOWN || *status == SHEEN_NO_SERVER)) {
        unsigned wait_ms = FIRST_RESUME_MS << job->n_resumes++;
        progress_clear(&job->progress);
        fprintf(stderr, "sheen: %s; connecting again in %.1f s (%u of %u)\n", job->error.text,
                wait_ms / 1e3, job->n_resumes, JOB_MAX_RESUMES);
        sheen_close(job->session);
        job->session = NULL;
        usleep(wait_ms * 1000);
        *status = connect_and_upload(job, options);
        if (!*status)
            return true;
    }
    return false;
}

static enum sheen_status upload_image(struct job *job, const char *path, uint8_t id[SHEEN_ID_BYTES])
{
    uint8_t *bytes = NULL;
    size_t n_bytes = 0;
    enum sheen_status status = file_read(path, SHEEN_BAD_IMAGE, &bytes, &n_bytes, &job->error);
    if (!status)
        status = identify(job, bytes, n_bytes, id);
    if (!status)
        status = upload(job, SHEEN_FILE_IMAGE, path, bytes, n_bytes, id);
    free(bytes);
    return status;
}

enum sheen_status job_upload_images(struct job *job, const struct options *options,
                                    struct sheen_request *request)
{
    enum sheen_status status = SHEEN_OK;
    for (uint32_t i = 0; !status && i < request->n_lights; i++)
        if (options->image_path[i])
            status = upload_image(job, options->image_path[i], request->lights[i].pattern.image_id);
    return status;
}

int job_finish(struct job *job, enum sheen_status status)
{
    progress_clear(&job->progress);
    if (status)
        fprintf(stderr, "sheen: %s\n", job->error.text);
    sheen_close(job->session);
    job->session = NULL;
    return sheen_status_exit_code(status);
}

enum sheen_status job_finish_json(struct job *job, struct json *json)
{
    if (json_finish(json))
        return SHEEN_OK;
    return status_set(&job->error, SHEEN_BAD_IMAGE, "standard output cannot be written");
}

void job_print_warnings(struct job *job, const char *model, const char *lines)
{
    progress_clear(&job->progress);
    while (*lines) {
        int length = (int)strcspn(lines, "\n");
        if (length > 0)
            fprintf(stderr, "sheen: warning: %s: %.*s\n", model, length, lines);
        lines += length + (lines[length] == '\n');
    }
}

void job_json_schedule(struct json *json, const struct sheen_request *request)
{
    json_string(json, "class", value_class_name(request->request_class));
    if (request->deadline_ms)
        json_uint(json, "deadline_ms", request->deadline_ms);
}

void job_json_times(struct json *json, const struct sheen_times *times)
{
    json_uint(json, "tables_us", times->tables_us);
    json_uint(json, "visibility_us", times->visibility_us);
    json_uint(json, "evaluate_us", times->evaluate_us);
    json_uint(json, "shade_us", times->shade_us);
    json_uint(json, "readback_us", times->readback_us);
    json_uint(json, "encode_us", times->encode_us);
    json_uint(json, "total_us", times->total_us);
}
