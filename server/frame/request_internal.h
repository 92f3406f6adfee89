/* What the files of this folder share about requests. Private to them.
 *
 * request.c        a request's life, and early ends
 * request_query.c  the description of a model
 * request_frame.c  how a frame is drawn
 * request_reply.c  how a frame is encoded and answered
 * compute.h        how numbers are computed
 *
 * Thread: the loop's. */
#ifndef SHEEN_FRAME_REQUEST_INTERNAL_H
#define SHEEN_FRAME_REQUEST_INTERNAL_H

#include "server/frame/request_client.h"
#include "server/frame/request_state.h"
#include "server/output/false_colour.h"
#include "server/output/metadata.h"

/* An asset of the store that a request needs. */
struct needed {
    struct request *request;
    struct asset *asset; /* in use or waited for; NULL: neither */
    struct asset_waiter waiter;
};

struct request {
    struct request_host *host;
    enum request_state state;
    struct party *party;             /* the client's; the request holds a reference of its own */
    struct request_client *client;   /* NULL: it has gone, or the request was answered early */
    LIST_ENTRY(request) client_link; /* while there is a client */
    LIST_ENTRY(request) parked_link; /* while REQUEST_PARKED or REQUEST_PROGRAMS */
    struct reply *reply;             /* valid while there is a client */
    uint32_t seq;
    uint8_t assets_of[OWNER_BYTES]; /* copied, because the client may go first */
    uint8_t asker[OWNER_BYTES];     /* the client's identity */
    bool is_query;                  /* a model query; else a frame, or a computation */
    struct compute *compute;        /* NULL: no computation */
    uint64_t start_us, deadline_us; /* clock_now_us(); deadline 0: none */

    struct needed model, images[MAX_LIGHTS];
    unsigned n_awaited;
    struct error failure; /* of kind ERROR_NONE: no failure yet */

    sheen_Render render; /* of a computation: its scene */
    struct frame_request frame_request;
    double up[3]; /* the model's up direction, for defaults */
    sheen_UpSource up_source;
    struct codec_layout layout;
    struct schedule_entry entry;
    uint64_t cost_key;
    uint64_t frame_bytes;
    struct renderer_held held_by_device; /* after the last step */
    /* Memory of the frame; NULL: none yet, or handed to the encoded frame. */
    struct memory_charge *charge;

    struct task task;      /* draws on the render thread, then paints false colour on the pool */
    atomic_bool abandoned; /* true: no client waits; other threads read it and stop early */
    struct frame_work frame_work;
    enum frame_step step;
    uint32_t wakes;   /* render_thread_wakes() before the latest step */
    uint64_t step_us; /* what the latest step took on the render thread */
    struct frame frame;
    sheen_Times times;
    bool is_blank; /* no pixel shows the model */
    struct false_colour_extremes extremes;
    bool has_light_share;
    double light_share; /* of the visible surface, the share whose rays meet a light; 0 to 1 */
    uint64_t encode_start_us;
    struct metadata metadata;
    struct needed polygons; /* set while the frame draws polygons that the device did not have */
    struct encoded *held;   /* set in state REQUEST_HELD */
};

/* --- request.c */

/* Asks the store for an asset. assets_ready() is called when all assets of the request are
 * there. */
void request_acquire(struct request *request, struct needed *needed, enum asset_kind kind,
                     const uint8_t *sha256);
/* Counts down what the request waits for. */
void request_stop_awaiting(struct request *request);
/* Frees the request. */
void request_end(struct request *request);
void request_fail(struct request *request, const struct error *error);
/* Answers that a newer request of the same view, by_seq, replaces this one, and abandons it. */
void request_reply_superseded(struct request *request, uint32_t by_seq);
bool request_is_late(const struct request *request, uint64_t now_us);
void request_reply_late(struct request *request);

/* --- request_query.c */

/* Starts to read the model's file from the folder of --models. On failure sets request->failure. */
void request_load_file(struct request *request, const char *name);
void request_reply_query(struct request *request);

/* --- request_frame.c */

/* Puts the frame into the scheduler's queue once all assets are there. Ends the request if it
 * cannot be drawn. */
void request_queue_frame(struct request *request);
/* Frees what is left of a frame that will not be sent. */
void request_drop_frame(struct request *request);

/* --- request_reply.c */

/* Hands the charge for the request's memory to what is sent. */
void request_hand_over_charge(struct request *request, struct encoded *encoded);
/* Starts to encode a frame that is drawn and painted; moves to REQUEST_ENCODING. */
void request_start_encoding(struct request *request);

static inline enum pool_urgency request_urgency(const struct request *request)
{
    return request->entry.request_class == CLASS_INTERACTIVE ? POOL_URGENT : POOL_SOON;
}

#endif
