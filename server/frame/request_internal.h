/* What the files of requests share: request.c has their life, request_frame.c how a frame is drawn.
 * Private to them. Thread: the loop's. */
#ifndef SHEEN_FRAME_REQUEST_INTERNAL_H
#define SHEEN_FRAME_REQUEST_INTERNAL_H

#include "server/output/metadata.h"
#include "server/frame/request.h"
#include "server/output/false_colour.h"

/* Something from the store that a request works with. */
struct needed {
    struct request *request;
    struct asset *asset; /* in use, or waited for; NULL: not */
    struct asset_waiter waiter;
};

struct request {
    struct session_host *host;
    struct session *session;         /* NULL once it is answered, or the session has gone */
    struct request *next, *previous; /* of the session */
    struct request *next_parked;     /* of the host, while is_parked */
    struct reply *reply;             /* valid while there is a session */
    uint32_t seq;
    uint8_t owner[STORE_OWNER_BYTES]; /* the session's */
    uint8_t asker[STORE_OWNER_BYTES]; /* the client's identity, also where all is shared */
    bool is_query, is_parked;
    bool is_busy;                   /* another thread works for it */
    uint64_t start_us, deadline_us; /* clock_now_us(); deadline 0: none */

    struct needed model, images[MAX_LIGHTS];
    unsigned n_awaited;
    struct error failure; /* kind ERROR_NONE: none yet */

    sheen_Render render;
    struct frame_request frame_request;
    double up[3]; /* of the model, for what the request left out */
    sheen_UpSource up_source;
    struct codec_layout layout;
    struct schedule_entry entry;
    uint64_t cost_key;
    uint64_t frame_bytes;
    struct memory_charge *charge; /* NULL: nothing yet, or the encoded frame's now */

    struct task task;      /* on the GL thread, then on the pool to paint false colour */
    atomic_bool abandoned; /* read by the GL thread and the pool's */
    struct frame_work frame_work;
    enum frame_step step;
    uint64_t step_us; /* the GL thread's time */
    struct frame frame;
    sheen_Times times;
    bool is_blank; /* no pixel shows any of the model */
    struct false_colour_extremes extremes;
    bool has_light_share;
    double light_share; /* of what is seen: where a light is met */
    uint64_t encode_start_us;
    struct metadata metadata;
    struct renderer_polygons *polygons; /* until the device has them */
    size_t polygon_bytes;               /* that they are charged with here */
    struct encoded *held;               /* encoded, until the socket can take it */
};

/* --- request.c */

/* The request's work is over. */
void request_end(struct request *request);
void request_fail(struct request *request, const struct error *error);
/* Gives the reply, and goes on without a session until nobody works for the request. */
void request_reply_superseded(struct request *request, uint32_t by_seq);
bool request_is_late(const struct request *request, uint64_t now_us);
void request_reply_late(struct request *request);

/* --- request_frame.c */

/* Everything is there: the frame joins the queue. Fails the request if it cannot be. */
void request_queue_frame(struct request *request);
/* What is left of a frame that will not be sent. */
void request_drop_frame(struct request *request);

#endif
