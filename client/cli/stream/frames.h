/* The frames of sheen stream: requests back to back while the camera or the light moves, and what
 * each stage took. */
#ifndef SHEEN_CLI_STREAM_FRAMES_H
#define SHEEN_CLI_STREAM_FRAMES_H

#include "client/cli/client.h"
#include "client/cli/options/options.h"

/* The times of one frame. All are the daemon's, except the last: from request to decoded frame. */
enum stage { TABLES, VISIBILITY, EVALUATE, SHADE, READBACK, ENCODE, TOTAL, ROUND_TRIP, N_STAGES };

struct record {
    enum { WANTED, DRAWN, LATE } state;
    uint32_t number; /* number of the frame, from 0 */
    uint64_t stage_us[N_STAGES];
    uint64_t data_bytes;
};

/* A request that was sent. Answers may come in another order: a refusal before an older frame, or a
 * frame that was requested again after a newer one. */
struct sent {
    uint32_t frame;
    int64_t us;
};

struct stream {
    struct sheen_request request;   /* its camera and light move */
    bool has_camera;                /* the camera is known */
    struct sheen_camera camera;     /* camera of the first frame */
    double axis[3];                 /* axis of the turntable: the model's up */
    enum sheen_up_source up_source; /* where that up comes from */
    uint64_t tables_us;             /* time that the first frame would have waited for tables */
    struct sheen_light light;       /* the first light, which moves */
    struct sheen_frame frame;
    struct sheen_model_info info;
    struct record *records;   /* [frames], indexed by frame number */
    uint32_t n_drawn, n_late; /* frames received; frames that missed their deadline */
    uint64_t written_bytes;   /* size of all files written */
    /* Indexed by the request's number modulo the array's size. */
    struct sent sent[SHEEN_MAX_IN_FLIGHT];
    int64_t start_us, elapsed_us; /* without the first frame, which may wait for tables */
};

/* From now on the first SIGINT ends stream_frames() after the frame that it waits for; the second ends the
 * process. */
void stream_end_at_interrupt(void);
bool stream_is_interrupted(void);

/* Requests all frames that have no answer yet. After a failure it may be called again with a new
 * session. */
enum sheen_status stream_frames(struct client *client, struct stream *stream,
                                const struct options *options);

#endif
