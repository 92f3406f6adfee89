/* A command as a client of a daemon, which most commands are: read a file, connect, upload, report,
 * give back.
 *
 * Thread: one. */
#ifndef SHEEN_CLIENT_CLIENT_H
#define SHEEN_CLIENT_CLIENT_H

#include "client/cli/output/json.h"
#include "client/cli/options/options.h"
#include "client/cli/output/progress.h"
#include "client/cli/resume.h"
#include "client/lib/sheen.h"

struct client {
    struct sheen_session *session;
    uint8_t model_id[SHEEN_ID_BYTES]; /* zeros for commands without a model */
    struct progress progress;
    struct sheen_progress report; /* for libsheen */
    struct sheen_error error;     /* of the last failure */
    struct resume resume;
    bool has_images; /* the session's daemon has all that the request shows */
};

/* Reads options->model (if any), connects and uploads it; goes on like client_resume() when that is
 * cut off. On failure client->error says why; the client must be finished all the same. */
enum sheen_status client_init(struct client *client, const struct options *options);

/* After a failure, *status, that the loss of the server at options->server is the reason of: tries
 * for options->reconnect_s seconds to connect to the one that takes its place and to upload the
 * model there, and says so in one line unless --quiet. True when it has, *status is SHEEN_OK then:
 * images are to be uploaded and what has no answer to be asked again. Else *status and
 * client->error say what stands in the way. */
bool client_resume(struct client *client, const struct options *options, enum sheen_status *status);

/* To be called for each answer: it is what client_resume() knows progress by. */
void client_answered(struct client *client);

/* Uploads the images of a command's lights, once a session, and writes their ids and the model's
 * into the request, which must be the same each time. */
enum sheen_status client_upload_images(struct client *client, const struct options *options,
                                       struct sheen_request *request);

/* client_upload_images() and one frame, from whichever server is there to draw it. No request may
 * be in flight. */
enum sheen_status client_render(struct client *client, const struct options *options,
                                struct sheen_request *request, struct sheen_frame *frame);

/* Gives everything back; prints client->error as one line if `status` is a failure. Returns the
 * exit code. */
int client_finish(struct client *client, enum sheen_status status);

/* Ends `json` on standard output; SHEEN_BAD_IMAGE when it cannot be written. */
enum sheen_status client_finish_json(struct client *client, struct json *json);

/* "sheen: warning: LINE" for each line; the lines name their file. */
void client_print_warnings(struct client *client, const char *lines);

/* Key class, and deadline_ms where there is one. */
void client_json_schedule(struct json *json, const struct sheen_request *request);

/* Keys device, driver, software, server, model_sha256 and weld: what made the frame, and of which
 * model. */
void client_json_origin(struct json *json, const struct client *client,
                        const struct options *options, const struct sheen_frame *frame);

/* Keys tables_us to total_us into the object that is open. */
void client_json_times(struct json *json, const struct sheen_times *times);

#endif
