/* What commands that use a daemon have in common: they read a file, connect, upload, report, and
 * clean up.
 *
 * Thread: one. */
#ifndef SHEEN_CLIENT_CLIENT_H
#define SHEEN_CLIENT_CLIENT_H

#include "client/cli/output/json.h"
#include "client/cli/options/options.h"
#include "client/cli/output/progress.h"
#include "client/cli/base/resume.h"
#include "client/lib/sheen.h"

struct client {
    struct sheen_session *session;
    uint8_t model_id[SHEEN_ID_BYTES]; /* zeros for commands without a model */
    struct progress progress;
    struct sheen_progress report; /* passed to libsheen */
    struct sheen_error error;     /* of the last failure */
    struct resume resume;
    bool has_images; /* the session's daemon has all images of the request */
};

/* Reads options->model (if any), connects, and uploads it. If the connection breaks meanwhile,
 * continues like client_resume(). On failure client->error has the reason. Call client_finish() in
 * both cases. */
enum sheen_status client_init(struct client *client, const struct options *options);

/* Uploads another model file, or finds one of the server's, and writes its id; it has no --weld. Call it again after
 * client_resume(). */
enum sheen_status client_add_model(struct client *client, const char *path,
                                   uint8_t id[SHEEN_ID_BYTES]);

/* Call it after a failure `*status`. If the reason is that the server at options->server was lost,
 * tries for options->reconnect_s seconds to connect again and to upload the model, and prints one
 * line unless --quiet. True on success: *status is then SHEEN_OK, and the caller must upload images
 * and repeat requests without an answer. Else false, and *status and client->error have the
 * reason. */
bool client_resume(struct client *client, const struct options *options, enum sheen_status *status);

/* Call it for each answer: client_resume() measures progress by answers. */
void client_answered(struct client *client);

/* Uploads the images of the command's lights, once for each session, and writes their ids and the
 * model's into *request, which must be the same at each call. */
enum sheen_status client_upload_images(struct client *client, const struct options *options,
                                       struct sheen_request *request);

/* client_upload_images() and one frame; reconnects if the server is lost. No request may be in
 * flight. */
enum sheen_status client_render(struct client *client, const struct options *options,
                                struct sheen_request *request, struct sheen_frame *frame);

/* Frees everything, and prints client->error as one line if `status` is a failure. Returns the exit
 * code. */
int client_finish(struct client *client, enum sheen_status status);

/* Ends `json` on standard output. SHEEN_BAD_IMAGE if it cannot be written. */
enum sheen_status client_finish_json(struct client *client, struct json *json);

/* Prints "sheen: warning: LINE" for each line of `lines`. The lines name their file. */
void client_print_warnings(struct client *client, const char *lines);

/* Writes the key class, and deadline_ms if there is a deadline. */
void client_json_schedule(struct json *json, const struct sheen_request *request);

/* Writes the keys device, driver, software, server, model_sha256 and weld: what made the frame, and
 * of which model. */
void client_json_origin(struct json *json, const struct client *client,
                        const struct options *options, const struct sheen_frame *frame);

/* Writes the keys tables_us to total_us. */
void client_json_times(struct json *json, const struct sheen_times *times);

/* Where the tables of a daemon's models lie, for "N bytes ...". software: as the daemon says of itself. */
static inline const char *client_place_of_tables(bool software)
{
    return software ? "in main memory" : "on the device";
}

#endif
