/* What the commands have in common: read a file, connect, upload, report, give back.
 *
 * Thread: one. */
#ifndef SHEEN_CLIENT_JOB_H
#define SHEEN_CLIENT_JOB_H

#include "client/json.h"
#include "client/options.h"
#include "client/progress.h"
#include "client/sheen.h"

struct job {
    struct sheen_session *session;
    uint8_t model_id[SHEEN_ID_BYTES]; /* zeros for commands without a model */
    struct progress progress;
    struct sheen_progress report; /* for libsheen */
    struct sheen_error error;     /* of the last failure */
    unsigned n_resumes;           /* how often job_resume() has tried to connect */
};

/* Reads options->model (if any), connects and uploads it. On failure job->error says why; the job
 * must be finished all the same. */
enum sheen_status job_init(struct job *job, const struct options *options);

/* After a failure, *status, that a shared daemon's end is the reason of: waits, twice as long each
 * time, connects to the daemon that takes its place and uploads the model again, JOB_MAX_RESUMES
 * times in all for a command, and says so on standard error. True when it has; images are to be
 * uploaded and what has no answer to be asked again. Else *status and job->error say what stands in
 * the way. */
#define JOB_MAX_RESUMES 5u
bool job_resume(struct job *job, const struct options *options, enum sheen_status *status);

/* Uploads the images of a command's lights and writes their ids into the request. */
enum sheen_status job_upload_images(struct job *job, const struct options *options,
                                    struct sheen_request *request);

/* Gives everything back; prints job->error as one line if `status` is a failure. Returns the exit
 * code. */
int job_finish(struct job *job, enum sheen_status status);

/* Ends `json` on standard output; SHEEN_BAD_IMAGE when it cannot be written. */
enum sheen_status job_finish_json(struct job *job, struct json *json);

/* "sheen: warning: MODEL: LINE" for each line. */
void job_print_warnings(struct job *job, const char *model, const char *lines);

/* Key class, and deadline_ms where there is one. */
void job_json_schedule(struct json *json, const struct sheen_request *request);

/* Keys tables_us to total_us into the object that is open. */
void job_json_times(struct json *json, const struct sheen_times *times);

#endif
