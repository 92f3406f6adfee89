/* What is kept of one client, and what all clients share. Data, for the files of this folder and for
 * the main service, which fills in struct session_host. Thread: the loop's. */
#ifndef SHEEN_SESSION_SESSION_STATE_H
#define SHEEN_SESSION_SESSION_STATE_H

#include <sys/queue.h>

#include "protocol/message.h"
#include "server/assets/upload.h"
#include "server/frame/request.h"
#include "server/net/access.h"
#include "server/net/conn.h"
#include "server/net/peer.h"
#include "server/net/strangers.h"
#include "server/session/reply.h"
#include "server/session/stats.h"
#include "server/threads/workers.h"

/* While more than this is unsent, nothing is read from the client and no still or batch is begun
 * for it: with those that have begun it bounds what a client that stops reading can cost. */
#define SESSION_MAX_UNSENT_BYTES (4u * 1024 * 1024)
/* The end of a connection: from shutdown() until the peer has closed too. */
#define SESSION_LINGER_US 2000000u
/* When drain-timeout has passed, all is answered, and so much later every connection is closed. */
#define SESSION_LAST_WORDS_US 1000000u
/* Without input for so long, a connection keeps no memory for long messages. */
#define SESSION_TRIM_US 1000000u

/* What one client may do, and for how long. */
struct session_limits {
    uint64_t max_upload;  /* bytes of one file */
    uint64_t max_frame;   /* bytes of one frame's planes */
    uint64_t credits;     /* unanswered requests of one connection */
    uint64_t connections; /* of one identity */

    /* What may wait to be sent, in bytes: more than `hard` when another answer comes, or more than
     * `soft` for so many seconds, ends the connection. */
    uint64_t interactive_hard, interactive_soft, interactive_s;
    uint64_t output_hard, output_soft, output_s; /* stills and batches */

    /* Times, in seconds. */
    uint64_t handshake_s; /* from accepting to HELLO */
    struct strangers_limits strangers;
    uint64_t message_s; /* from a message's first byte to its last */
    uint64_t stall_s;   /* without a byte sent or of an upload received */
    uint64_t idle_s;    /* without a request; 0: for ever */
    uint64_t drain_s;   /* to finish and send what is asked when the daemon ends */
};

/* What all sessions share; outlives them. */
struct session_host {
    struct loop *loop;
    struct access *access; /* another one after a reload */
    struct render_thread *render_thread;
    struct workers *workers;
    struct block_cache *block_cache; /* the memory of replies */
    struct store *store;
    struct memory *memory;
    struct request_host *requests;
    struct session_limits limits;
    const struct asset_limits *asset_limits;
    uint64_t max_upload_bytes;
    bool share_models; /* whatever is uploaded is everybody's */
    bool is_private;   /* a command's own daemon: the budget of memory is its client's choice */

    struct stats stats;
    uint32_t n_sessions;
    struct strangers strangers; /* of them, not yet admitted */
    uint64_t last_session_id;   /* sessions are numbered in the log */
    bool draining;              /* no new request is taken, and answers must be read soon */
    uint64_t drain_start_us;
};

/* A client as it comes in. */
struct session_client {
    enum { CLIENT_PRIVATE, CLIENT_UNIX, CLIENT_TCP, CLIENT_TLS } kind;
    char peer[PEER_TEXT_BYTES]; /* for the log */
    struct peer from;           /* CLIENT_TLS */
    bool is_balancer;           /* what has come is the balancer's own, not a client's */
    struct identity identity;   /* CLIENT_TLS: not before HELLO */
};

/* What a client has once it is known who it is: its part of the daemon. */
struct session_seat {
    struct client_quota *quota;
    struct party *party;
};

struct session {
    struct session_host *host;
    struct conn conn;
    struct reply_list replies;
    struct request_client requests;
    uint64_t id; /* in the log */
    uint64_t start_us;
    uint64_t n_replies;
    enum stats_end end; /* why it ends, once the daemon has decided that it does */
    struct session_client client;
    struct session_seat seat; /* zeroed until the client is admitted */
    struct stranger stranger; /* while `is_stranger` */
    bool is_stranger;
    bool admitted;  /* the client is who it says; till then it is told nothing */
    bool greeted;   /* HELLO has been answered */
    uint32_t minor; /* version spoken with the client */
    uint32_t credits;
    enum request_class output_class; /* of the latest frame: whose output limits hold */
    uint64_t over_soft_since_us;     /* 0: no more is unsent than the soft limit allows */
    bool refused;                    /* the last answer is on its way: nothing is read any more */
    struct upload *upload;           /* NULL: none under way */
    uint32_t upload_seq;             /* of the upload, or of the last one that failed; else 0 */
    size_t input_bytes;              /* charged for conn.in where it is larger than most are */
    LIST_ENTRY(session) link;        /* the main service's */
};

#endif
