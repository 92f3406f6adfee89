/* What the files of requests share: request.c has their life and how they end early, request_query.c
 * the description of a model, request_frame.c how a frame is drawn, request_reply.c how it is
 * answered. Private to them. Thread: the loop's. */
#ifndef SHEEN_FRAME_REQUEST_INTERNAL_H
#define SHEEN_FRAME_REQUEST_INTERNAL_H

#include "server/frame/request_client.h"
#include "server/frame/request_state.h"
#include "server/output/false_colour.h"
#include "server/output/metadata.h"

/* Something from the store that a request works with. */
struct needed {
    struct request *request;
    struct asset *asset; /* in use, or waited for; NULL: not */
    struct asset_waiter waiter;
};

struct request {
    struct request_host *host;
    enum request_state state;
    struct party *party;             /* the client's, which may go before */
    struct request_client *client;   /* NULL: REQUEST_ABANDONED, or about to be */
    LIST_ENTRY(request) client_link; /* while there is a client */
    LIST_ENTRY(request) parked_link; /* while REQUEST_PARKED */
    struct reply *reply;             /* valid while there is a client */
    uint32_t seq;
    uint8_t assets_of[OWNER_BYTES]; /* the client's, which may go before */
    uint8_t asker[OWNER_BYTES];     /* the client's identity */
    bool is_query;                  /* of a model; else of a frame */
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

    struct task task;      /* on the render thread, then on the pool to paint false colour */
    atomic_bool abandoned; /* no client: read by other threads, which then stop early */
    struct frame_work frame_work;
    enum frame_step step;
    uint64_t step_us; /* the render thread's time */
    struct frame frame;
    sheen_Times times;
    bool is_blank; /* no pixel shows any of the model */
    struct false_colour_extremes extremes;
    bool has_light_share;
    double light_share; /* of what is seen: where a light is met */
    uint64_t encode_start_us;
    struct metadata metadata;
    struct needed polygons; /* from when the device lacks them until the frame ends */
    struct encoded *held;   /* while REQUEST_HELD */
};

/* --- request.c */

/* Asks the store for an asset of the client's; assets_ready() follows when all that the request
 * needs is there. */
void request_acquire(struct request *request, struct needed *needed, enum asset_kind kind,
                     const uint8_t *sha256);
/* One thing less is waited for. */
void request_stop_awaiting(struct request *request);
/* The request's work is over. */
void request_end(struct request *request);
void request_fail(struct request *request, const struct error *error);
/* Gives the reply, and goes on without a client until nobody works for the request. */
void request_reply_superseded(struct request *request, uint32_t by_seq);
bool request_is_late(const struct request *request, uint64_t now_us);
void request_reply_late(struct request *request);

/* --- request_query.c */

/* Begins to read the model's file, which lies at the daemon; request->failure says why not. */
void request_load_file(struct request *request, const char *name);
void request_reply_query(struct request *request);

/* --- request_frame.c */

/* All assets are there: the frame joins the queue. Fails the request if it cannot be drawn. */
void request_queue_frame(struct request *request);
/* Frees what is left of a frame that will not be sent. */
void request_drop_frame(struct request *request);

/* --- request_reply.c */

/* All tiles are drawn, and painted: REQUEST_ENCODING follows. */
void request_start_encoding(struct request *request);

static inline enum pool_urgency request_urgency(const struct request *request)
{
    return request->entry.request_class == CLASS_INTERACTIVE ? POOL_URGENT : POOL_SOON;
}

#endif
