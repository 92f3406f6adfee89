/* All parts of the daemon in one struct, for the files of this folder: the service creates and
 * destroys the parts; the monitor and the metrics read them.
 * Thread: the loop's. */
#ifndef SHEEN_OPS_DAEMON_H
#define SHEEN_OPS_DAEMON_H

#include "server/ops/limits.h"
#include "server/session/session.h"
#include "server/threads/pool.h"
#include "server/threads/render_thread.h"

struct daemon {
    uint64_t most_clients; /* that there are descriptors for */
    struct limits limits;  /* the limits in force */
    struct loop *loop;
    struct completions *completions;
    struct block_cache *block_cache;
    struct workers workers;
    struct render_thread *render_thread;
    struct pool *pool;    /* builds tables, paints false colour, encodes frames */
    struct pool *readers; /* threads that wait for the worker programs */
    struct access *access;
    struct store *store;
    struct memory memory;
    struct request_host requests;
    struct session_host sessions;
};

#endif
