/* What a request knows of its client, and what all requests share. Data. Thread: the loop's. */
#ifndef SHEEN_FRAME_REQUEST_CLIENT_H
#define SHEEN_FRAME_REQUEST_CLIENT_H

#include <sys/queue.h>

#include "protocol/message.h"
#include "server/assets/memory.h"
#include "server/frame/costs.h"
#include "server/frame/parties.h"
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
    struct parties parties;
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
    void *owner; /* of the events */
    struct client_quota
        *quota;          /* that frames are charged to; of the client's identity, as `party` */
    struct party *party; /* both NULL until the client has joined, and asks for nothing */
    /* The client's identity, and the owner of the assets that it may use beside those of
     * everybody; OWNER_BYTES each. */
    const uint8_t *identity, *assets_of;

    struct schedule_queue queue;
    struct request_list requests; /* not yet answered */
};

#endif
