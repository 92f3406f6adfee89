/* A request that takes time: a model's description or a frame. It waits for what it needs from the
 * store, for memory, for its turn, for the render thread and for the encoder, and then tells its
 * client's session.
 *
 * A request frees itself after its reply. When it is answered early (replaced, cancelled, late) or
 * its client has gone, it frees itself as soon as no thread and no build works for it any more.
 * request_state.h lists the states of a request. Thread: the loop's. */
#ifndef SHEEN_FRAME_REQUEST_H
#define SHEEN_FRAME_REQUEST_H

#include <sys/queue.h>

#include "protocol/message.h"
#include "server/assets/memory.h"
#include "server/frame/costs.h"
#include "server/frame/scheduler.h"
#include "server/output/encode.h"

struct request;
LIST_HEAD(request_list, request);

struct reply; /* where a client's session keeps what it owes to one request: known there alone */

/* What all requests share. It outlives all requests. */
struct request_host {
    struct pool *pool;
    struct render_thread *render_thread;
    struct workers *workers;
    struct block_cache *block_cache; /* the memory of frames and of requests */
    struct memory *memory;
    struct store *store;
    int models_fd;           /* the folder of --models; -1: none */
    uint64_t max_file_bytes; /* of one file there */
    uint32_t gpu_generation; /* 1, and one more for each time that the GPU was lost */

    struct scheduler scheduler;
    struct costs costs;
    struct request_list parked; /* requests that wait for memory of other frames */
    unsigned n_file_loads;      /* files being read from the folder */
};

/* How a request tells its client's session what has become of it. Each request calls one of the
 * first three, once, unless the client goes before. Called on the loop's thread; a function may
 * close the client's connection, but calls none of the functions below. */
struct request_events {
    /* Answered by a message of this type; `body` is the struct of the type (message.h). */
    void (*answered)(void *owner, struct reply *reply, uint8_t type, const void *body);
    /* Answered by an error. */
    void (*refused)(void *owner, struct reply *reply, sheen_ErrorCode code, const char *text);
    /* A frame and its DATA, which the session takes over. */
    void (*drawn)(void *owner, struct reply *reply, enum request_class request_class,
                  const sheen_Frame *frame, struct encoded *encoded);
    /* A build that the request waits for goes on. */
    void (*progressed)(void *owner, const struct reply *reply, const sheen_Progress *progress);
    /* Is an interactive frame on its way to the socket, so that the next has to wait? */
    bool (*is_sending)(void *owner);
};

/* A client as its requests see it; part of its session. */
struct request_client {
    struct request_host *host;
    const struct request_events *events;
    void *owner;                /* of the events */
    struct client_quota *quota; /* that frames are charged to */
    /* The client's identity, and the owner of the assets that it may use beside those of
     * everybody; STORE_OWNER_BYTES each. */
    const uint8_t *identity, *assets_of;

    struct schedule_queue queue;
    struct request_list requests; /* not yet answered */
};

/* Sets `queue` and `requests`; the caller has set all other members. */
void request_client_init(struct request_client *client);
/* The client has gone: gives up all its requests. */
void request_client_finish(struct request_client *client);

/* The class of a message's number. */
enum request_class request_class_of(sheen_RequestClass request_class);

/* What the device keeps for a frame that is drawn in parts, while others are drawn: 0 but for
 * polygons. `render` has passed message_check_render(). */
uint64_t request_paused_bytes(const struct request_host *host, const sheen_Render *render);

/* Both fill `reply` in the end, unless the client goes; they may have ended when they return. */
void request_query(struct request_client *client, struct reply *reply, uint32_t seq,
                   const sheen_ModelQuery *query);
/* `render` has passed message_check_render(); its frame takes so many bytes of the budget, which
 * allows them. */
void request_render(struct request_client *client, struct reply *reply, uint32_t seq,
                    const sheen_Render *render, uint64_t frame_bytes);

/* Answers the request of this number ERROR_CANCELLED, if it has not been answered. */
void request_cancel(struct request_client *client, uint32_t seq);
/* Answers all requests of the client ERROR_CANCELLED. */
void request_cancel_all(struct request_client *client);
/* Answers all of the client's ERROR_SHUTTING_DOWN: the daemon's time to finish them, so many
 * seconds, is over. */
void request_shut_down_all(struct request_client *client, uint64_t drain_s);
/* Answers the client's requests whose deadline has passed ERROR_DEADLINE. */
void request_end_late(struct request_client *client, uint64_t now_us);
/* The client's socket has taken its interactive frame: the next that is ready goes. */
void request_send_held(struct request_client *client);
/* Tells how far the builds are that the client's requests wait for. */
void request_report_progress(struct request_client *client);

/* Starts what the scheduler says is next, until it says nothing. */
void request_start_next(struct request_host *host);

#endif
