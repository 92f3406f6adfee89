/* The data that requests need of their client, and the data that all requests share. Defines the
 * events by which a request reports to its client's session.
 * Thread: the loop's. */
#ifndef SHEEN_FRAME_REQUEST_CLIENT_H
#define SHEEN_FRAME_REQUEST_CLIENT_H

#include <sys/queue.h>

#include "protocol/messages/message.h"
#include "server/assets/memory.h"
#include "server/frame/costs.h"
#include "server/frame/parties.h"
#include "server/frame/scheduler.h"
#include "server/output/encode.h"

struct request;
LIST_HEAD(request_list, request);
struct compute;
TAILQ_HEAD(compute_line, compute);

struct reply; /* the session's record of a reply that it owes; opaque here */

/* What all requests share. It outlives all requests. */
struct request_host {
    struct pool *pool;
    struct render_thread *render_thread;
    struct workers *workers;
    struct block_cache *block_cache; /* memory of frames and requests */
    struct memory *memory;
    struct store *store;
    int models_fd;           /* the folder of --models; -1: none */
    uint64_t max_file_bytes; /* largest file in that folder */
    uint32_t gpu_generation; /* 1, plus 1 for each loss of the GPU */

    struct scheduler scheduler;
    struct parties parties;
    struct costs costs;
    struct request_list parked;    /* requests that wait until other frames free memory */
    struct request_list preparing; /* requests that wait for the device's programs */
    uint32_t wakes;                /* the latest render_thread_wakes() that they were told */
    unsigned n_file_loads;         /* files being read from the folder */
    struct compute_line in_line;   /* computations that wait, in the order of their coming */
    unsigned n_computing;          /* computations that run */
};

/* The events by which a request reports to its client's session. Each request calls exactly one of
 * the first four, once, unless the client goes before. They run on the loop's thread. An event may
 * close the client's connection; it must not call the functions of request.h. */
struct request_events {
    /* The reply is a message of this type; `body` is the type's struct (message.h). */
    void (*answered)(void *owner, struct reply *reply, uint8_t type, const void *body);
    /* The reply is an error. */
    void (*refused)(void *owner, struct reply *reply, sheen_ErrorCode code, const char *text);
    /* The reply is a frame with its DATA; the session takes the ownership of `encoded`. */
    void (*drawn)(void *owner, struct reply *reply, enum request_class request_class,
                  const sheen_Frame *frame, struct encoded *encoded);
    /* The reply is a message of this type, as in answered(), with DATA behind it; `records` is NULL
     * without DATA. The session takes the ownership of `records`. */
    void (*computed)(void *owner, struct reply *reply, uint8_t type, const void *body,
                     struct encoded *records);
    /* A build that the request waits for, or its computation, has made progress. Not a reply. */
    void (*progressed)(void *owner, const struct reply *reply, const sheen_Progress *progress);
    /* True while the socket has not taken an earlier interactive frame, so that the next one must
     * wait. */
    bool (*is_sending)(void *owner);
};

/* What requests know of their client; a member of its session. */
struct request_client {
    struct request_host *host;
    const struct request_events *events;
    void *owner;                /* passed to the events */
    struct client_quota *quota; /* account of the client's frames */
    struct party *party;        /* quota and party are NULL until request_client_join() */
    /* The client's identity, and the owner of the assets that it may use in addition to those of
     * everybody; OWNER_BYTES each. */
    const uint8_t *identity, *assets_of;

    struct schedule_queue queue;
    struct request_list requests; /* not yet answered */
};

#endif
