#include "client/cli/client.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "client/cli/base/clock.h"
#include "client/cli/files/file.h"
#include "client/cli/base/failure.h"
#include "client/cli/options/values.h"
#include "client/cli/files/weld_tag.h"

#define TOKEN_BYTES 256
#define AT_SERVER "server:" /* prefix of a MODEL that is a file in the daemon's folder (--models) */

static enum sheen_status upload(struct client *client, enum sheen_file_kind kind, const char *path,
                                const uint8_t *bytes, size_t n_bytes,
                                const uint8_t id[SHEEN_ID_BYTES])
{
    return sheen_upload(client->session, kind, id, bytes, n_bytes, path, &client->report,
                        &client->error);
}

static enum sheen_status identify(struct client *client, const uint8_t *bytes, size_t n_bytes,
                                  uint8_t id[SHEEN_ID_BYTES])
{
    if (sheen_file_id(bytes, n_bytes, id))
        return SHEEN_OK;
    return failure_set(&client->error, SHEEN_NO_MEMORY, "libcrypto cannot compute a SHA-256");
}

/* The file is read again for each server. If it has changed, fails: answers about two versions of a
 * file must not be mixed. */
static enum sheen_status keep_id(struct client *client, uint8_t kept[SHEEN_ID_BYTES],
                                 const uint8_t id[SHEEN_ID_BYTES], enum sheen_status status,
                                 const char *path)
{
    if (client->resume.is_answered && memcmp(kept, id, SHEEN_ID_BYTES) != 0)
        return failure_set(&client->error, status,
                           "%s: it has changed since the first answer about it came; ask for "
                           "everything again",
                           path);
    memcpy(kept, id, SHEEN_ID_BYTES);
    return SHEEN_OK;
}

static enum sheen_status take_id(struct client *client, const char *path, enum sheen_status bad,
                                 const uint8_t *bytes, size_t n_bytes, uint8_t kept[SHEEN_ID_BYTES])
{
    uint8_t id[SHEEN_ID_BYTES];
    enum sheen_status status = identify(client, bytes, n_bytes, id);
    return status ? status : keep_id(client, kept, id, bad, path);
}

/* Reads the model's bytes as they are sent. The caller frees them, whatever the status is. */
static enum sheen_status read_model(struct client *client, const struct options *options,
                                    uint8_t **bytes, size_t *n_bytes)
{
    const char *path = options->model;
    enum sheen_status status =
        sheen_read_file(SHEEN_FILE_MODEL, path, bytes, n_bytes, &client->error);
    if (!status && options->weld)
        status = weld_tag_append(path, bytes, n_bytes, &client->error);
    return status ? status
                  : take_id(client, path, SHEEN_BAD_MODEL, *bytes, *n_bytes, client->model_id);
}

static bool is_at_server(const char *model)
{
    return model && strncmp(model, AT_SERVER, strlen(AT_SERVER)) == 0;
}

/* The id by which a load balancer chooses a node. A file at the server has no known id before a
 * server is asked, so its name is hashed instead, every time, so that the choice stays the same. */
static enum sheen_status greeting_id(struct client *client, const char *model,
                                     uint8_t id[SHEEN_ID_BYTES])
{
    if (is_at_server(model))
        return identify(client, (const uint8_t *)model, strlen(model), id);
    memcpy(id, client->model_id, SHEEN_ID_BYTES);
    return SHEEN_OK;
}

/* Connects. `timeout_ms` is for connecting; 0: as for all calls. */
static enum sheen_status connect_server(struct client *client, const struct options *options,
                                        uint32_t timeout_ms)
{
    struct sheen_connect_options connect = SHEEN_CONNECT_DEFAULTS;
    enum sheen_status status = greeting_id(client, options->model, connect.model_id);
    if (status)
        return status;
    connect.connect_timeout_ms = timeout_ms;
    connect.address = options->server;
    connect.device = options->device;
    connect.native_isa = options->native_isa;
    connect.native_threads = options->native_threads;
    connect.memory_budget_bytes = options->memory_budget_bytes;
    connect.ca = options->ca;
    connect.cert = options->cert;
    connect.key = options->key;
    connect.share = options->share;
    char token[TOKEN_BYTES];
    if (options->token_file) {
        status = file_read_line(options->token_file, token, sizeof(token), &client->error);
        if (status)
            return status;
        connect.token = token;
    }
    return sheen_connect(&client->session, &connect, &client->error);
}

static enum sheen_status find_model(struct client *client, const char *name)
{
    uint8_t id[SHEEN_ID_BYTES];
    enum sheen_status status =
        sheen_find_model(client->session, name, &client->report, id, &client->error);
    return status ? status : keep_id(client, client->model_id, id, SHEEN_BAD_MODEL, name);
}

static enum sheen_status connect_and_upload(struct client *client, const struct options *options,
                                            uint32_t timeout_ms)
{
    uint8_t *bytes = NULL;
    size_t n_bytes = 0;
    bool at_server = is_at_server(options->model);
    bool local = options->model && !at_server;
    enum sheen_status status = SHEEN_OK;
    client->has_images = false;
    if (local)
        status = read_model(client, options, &bytes, &n_bytes);
    else if (at_server && options->weld)
        status = failure_set(&client->error, SHEEN_BAD_ARGUMENT,
                             "%s: --weld is for a file that is sent; for one at the server put the "
                             "line 't weld 0/0/0' into it",
                             options->model);
    if (!status)
        status = connect_server(client, options, timeout_ms);
    if (!status && at_server)
        status = find_model(client, options->model + strlen(AT_SERVER));
    if (!status && local)
        status = upload(client, SHEEN_FILE_MODEL, options->model, bytes, n_bytes, client->model_id);
    free(bytes);
    return status;
}

enum sheen_status client_add_model(struct client *client, const char *path,
                                   uint8_t id[SHEEN_ID_BYTES])
{
    uint8_t *bytes = NULL;
    size_t n_bytes = 0;
    if (is_at_server(path))
        return sheen_find_model(client->session, path + strlen(AT_SERVER), &client->report, id,
                                &client->error);
    enum sheen_status status =
        sheen_read_file(SHEEN_FILE_MODEL, path, &bytes, &n_bytes, &client->error);
    if (!status)
        status = identify(client, bytes, n_bytes, id);
    if (!status)
        status = upload(client, SHEEN_FILE_MODEL, path, bytes, n_bytes, id);
    free(bytes);
    return status;
}

enum sheen_status client_init(struct client *client, const struct options *options)
{
    *client = (struct client){.resume = {.limit_ms = options->reconnect_s * 1000}};
    client->report = progress_init(&client->progress, options->quiet);
    enum sheen_status status = connect_and_upload(client, options, 0);
    if (status)
        client_resume(client, options, &status);
    return status;
}

/* A connection was lost: starts the time for reconnecting. False if it was lost too often. */
static bool begin_resume(struct client *client, const struct options *options)
{
    char text[sizeof(client->error.text)];
    if (resume_lost(&client->resume, clock_now_ms())) {
        progress_note(&client->progress, "%s; connecting again for up to %u s", client->error.text,
                      options->reconnect_s);
        return true;
    }
    snprintf(text, sizeof(text), "%s", client->error.text);
    failure_set(&client->error, client->error.status,
                "%.400s; %u servers in a row went before they answered: see their logs before "
                "asking again",
                text, client->resume.n_losses);
    return false;
}

static void nap(uint32_t ms)
{
    struct timespec left = {.tv_sec = ms / 1000, .tv_nsec = ms % 1000 * 1000000L};
    while (nanosleep(&left, &left) != 0 && errno == EINTR)
        ;
}

bool client_resume(struct client *client, const struct options *options, enum sheen_status *status)
{
    /* If no server ever answered at this address, the address may be wrong: that is no loss. */
    bool is_lost =
        *status == SHEEN_SHUTTING_DOWN || (*status == SHEEN_LOST_SERVER && client->session != NULL);
    bool is_new = true;
    uint32_t wait_ms;
    if (!options->server || options->reconnect_s == 0)
        return false;
    while (is_lost) {
        if ((is_new || client->session) && !begin_resume(client, options))
            return false;
        is_new = false;
        sheen_close(client->session);
        client->session = NULL;
        if (!resume_wait(&client->resume, clock_now_ms(), &wait_ms))
            return false;
        nap(wait_ms);
        *status =
            connect_and_upload(client, options, resume_try_ms(&client->resume, clock_now_ms()));
        if (!*status)
            return true;
        is_lost = *status == SHEEN_SHUTTING_DOWN || *status == SHEEN_LOST_SERVER ||
                  *status == SHEEN_NO_SERVER;
    }
    return false;
}

void client_answered(struct client *client)
{
    resume_answered(&client->resume);
}

static enum sheen_status upload_image(struct client *client, const char *path,
                                      uint8_t id[SHEEN_ID_BYTES])
{
    uint8_t *bytes = NULL;
    size_t n_bytes = 0;
    enum sheen_status status =
        sheen_read_file(SHEEN_FILE_IMAGE, path, &bytes, &n_bytes, &client->error);
    if (!status)
        status = take_id(client, path, SHEEN_BAD_IMAGE, bytes, n_bytes, id);
    if (!status)
        status = upload(client, SHEEN_FILE_IMAGE, path, bytes, n_bytes, id);
    free(bytes);
    return status;
}

enum sheen_status client_upload_images(struct client *client, const struct options *options,
                                       struct sheen_request *request)
{
    memcpy(request->model_id, client->model_id, SHEEN_ID_BYTES);
    if (client->has_images)
        return SHEEN_OK;
    enum sheen_status status = SHEEN_OK;
    for (uint32_t i = 0; !status && i < request->n_lights; i++)
        if (options->image_path[i])
            status =
                upload_image(client, options->image_path[i], request->lights[i].pattern.image_id);
    client->has_images = status == SHEEN_OK;
    return status;
}

enum sheen_status client_render(struct client *client, const struct options *options,
                                struct sheen_request *request, struct sheen_frame *frame)
{
    enum sheen_status status;
    do {
        status = client_upload_images(client, options, request);
        if (!status)
            status = sheen_render(client->session, request, &client->report, frame, &client->error);
    } while (status && client_resume(client, options, &status));
    if (!status)
        client_answered(client);
    else if (status == SHEEN_LATE && request->deadline_ms)
        failure_set(&client->error, status,
                    "the frame was not drawn within --deadline %u (milliseconds): give it more "
                    "time, or ask again when the daemon has less to do",
                    request->deadline_ms);
    return status;
}

int client_finish(struct client *client, enum sheen_status status)
{
    progress_clear(&client->progress);
    if (status)
        fprintf(stderr, "sheen: %s\n", client->error.text);
    sheen_close(client->session);
    client->session = NULL;
    return sheen_status_exit_code(status);
}

enum sheen_status client_finish_json(struct client *client, struct json *json)
{
    if (json_finish(json))
        return SHEEN_OK;
    return failure_set(&client->error, SHEEN_BAD_IMAGE, "standard output cannot be written");
}

void client_print_warnings(struct client *client, const char *lines)
{
    progress_clear(&client->progress);
    while (*lines) {
        int length = (int)strcspn(lines, "\n");
        if (length > 0)
            fprintf(stderr, "sheen: warning: %.*s\n", length, lines);
        lines += length + (lines[length] == '\n');
    }
}

void client_json_schedule(struct json *json, const struct sheen_request *request)
{
    json_text(json, "class", value_class_name(request->request_class));
    if (request->deadline_ms)
        json_uint(json, "deadline_ms", request->deadline_ms);
}

void client_json_origin(struct json *json, const struct client *client,
                        const struct options *options, const struct sheen_frame *frame)
{
    json_text(json, "device", frame->device);
    json_text(json, "driver", frame->driver);
    json_bool(json, "software", frame->software);
    json_uint(json, "threads", frame->threads);
    json_text(json, "server", frame->server);
    json_hex(json, "model_sha256", client->model_id, SHEEN_ID_BYTES);
    json_bool(json, "weld", options->weld);
}

void client_json_times(struct json *json, const struct sheen_times *times)
{
    json_uint(json, "tables_us", times->tables_us);
    json_uint(json, "visibility_us", times->visibility_us);
    json_uint(json, "evaluate_us", times->evaluate_us);
    json_uint(json, "shade_us", times->shade_us);
    json_uint(json, "readback_us", times->readback_us);
    json_uint(json, "encode_us", times->encode_us);
    json_uint(json, "total_us", times->total_us);
}
