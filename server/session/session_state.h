/* The data of one session, and the data that all sessions share. For the files of this folder and
 * for the main service, which fills in struct session_host.
 * Thread: the loop's. */
#ifndef SHEEN_SESSION_SESSION_STATE_H
#define SHEEN_SESSION_SESSION_STATE_H

#include <sys/queue.h>

#include "protocol/messages/message.h"
#include "server/assets/upload.h"
#include "server/frame/request.h"
#include "server/net/access.h"
#include "server/net/conn.h"
#include "server/net/peer.h"
#include "server/net/strangers.h"
#include "server/session/reply.h"
#include "server/session/stats.h"
#include "server/threads/workers.h"

/* While a connection has more unsent bytes than this, nothing is read from its client and no still
 * or batch frame is begun for it. This limit and the frames already begun bound the memory that a
 * client can hold by not reading. */
#define SESSION_MAX_UNSENT_BYTES (4u * 1024 * 1024)
/* At the end of a connection: the longest time from shutdown() until the peer closes too. */
#define SESSION_LINGER_US 2000000u
/* When drain-timeout has passed, every request is answered; so many ticks of the loop later all
 * connections close. Ticks and not a time: after a machine has stopped the daemon for a while, clients
 * still have their answers before their connections close. */
#define SESSION_LAST_WORDS_TICKS (1000000u / LOOP_TICK_US)
/* After this time without input, a connection frees its memory for long messages. */
#define SESSION_TRIM_US 1000000u

/* The limits of one client. */
struct session_limits {
    uint64_t max_upload;  /* bytes of one file */
    uint64_t max_frame;   /* bytes of one frame's planes */
    uint64_t credits;     /* unanswered requests of one connection, at most */
    uint64_t connections; /* connections of one identity */

    /* Unsent output, in bytes. The connection ends if more than `hard` is unsent when another reply
     * is due, or if more than `soft` stays unsent for so many seconds (_s). */
    uint64_t interactive_hard, interactive_soft, interactive_s;
    uint64_t output_hard, output_soft, output_s; /* for stills and batches */

    /* Times, in seconds. */
    uint64_t handshake_s; /* from connecting to HELLO */
    struct strangers_limits strangers;
    uint64_t message_s; /* from a message's first byte to its last */
    uint64_t stall_s;   /* without progress of the output, or of an upload */
    uint64_t idle_s;    /* without a request; 0: no limit */
    uint64_t drain_s;   /* to finish and send the requests in flight when the daemon ends */
};

/* What all sessions share; outlives them. */
struct session_host {
    struct loop *loop;
    struct access *access; /* replaced by a reload */
    struct render_thread *render_thread;
    struct workers *workers;
    struct block_cache *block_cache; /* memory of replies */
    struct store *store;
    struct memory *memory;
    struct request_host *requests;
    struct session_limits limits;
    const struct asset_limits *asset_limits;
    uint64_t max_upload_bytes;
    bool share_models; /* every client may use all uploaded files */
    /* A daemon that a command started for itself: its client chooses the memory budget. */
    bool is_private;

    struct stats stats;
    uint32_t n_sessions;
    struct strangers strangers; /* sessions that are not admitted yet */
    uint64_t last_session_id;   /* the number of the latest session, for the log */
    /* The daemon ends: new requests are refused, replies must be read soon. */
    bool draining;
    uint64_t drain_start_us;
    uint32_t overdue_ticks; /* ticks since drain-timeout has passed; 0: it has not */
};

/* What is known of a client when it connects. */
struct session_client {
    enum { CLIENT_PRIVATE, CLIENT_UNIX, CLIENT_TCP, CLIENT_TLS } kind;
    char peer[PEER_TEXT_BYTES]; /* for the log */
    struct peer from;           /* CLIENT_TLS */
    bool is_balancer;           /* the connection is from a balancer itself, not from its client */
    struct identity identity;   /* CLIENT_TLS: known only after HELLO */
};

/* An identified client's share of the daemon: its quota of memory and connections, and its party in
 * the scheduler. Holds a reference to each. */
struct session_seat {
    struct client_quota *quota;
    struct party *party;
};

struct session {
    struct session_host *host;
    struct conn conn;
    struct reply_list replies;
    struct request_client requests;
    uint64_t id; /* number of the session in the log */
    uint64_t start_us;
    uint64_t n_replies;
    enum stats_end end; /* why the session ends, if the daemon ends it */
    struct session_client client;
    struct session_seat seat; /* zero until the client is admitted */
    struct stranger stranger; /* valid while is_stranger */
    bool is_stranger;
    bool admitted;  /* the client's identity is proven; until then it is told nothing */
    bool greeted;   /* HELLO has been answered */
    uint32_t minor; /* minor version of the protocol in use */
    uint32_t credits;
    enum request_class output_class; /* class of the latest frame, whose output limits apply */
    /* Since when the unsent output exceeds the soft limit; 0: it does not. */
    uint64_t over_soft_since_us;
    bool refused;          /* the last reply is on its way: nothing is read any more */
    struct upload *upload; /* the upload under way, or NULL */
    /* Number of the upload under way, or of the latest one that failed; else 0. */
    uint32_t upload_seq;
    size_t input_bytes;       /* bytes charged for conn.in beyond its initial size */
    LIST_ENTRY(session) link; /* in the main service's list */
};

#endif
