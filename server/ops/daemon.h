/* All parts of the daemon, as the files of this folder see them: service.c makes and ends them, the
 * monitor and the metrics read them. Thread: the loop's. */
#ifndef SHEEN_OPS_DAEMON_H
#define SHEEN_OPS_DAEMON_H

#include "server/ops/limits.h"
#include "server/session/session.h"
#include "server/threads/pool.h"
#include "server/threads/render_thread.h"

struct daemon {
    struct limits limits; /* those in force */
    struct loop *loop;
    struct completions *completions;
    struct block_cache *block_cache;
    struct workers workers;
    struct render_thread *render_thread;
    struct pool *pool;    /* fills tables, paints and encodes */
    struct pool *readers; /* wait for the worker programs */
    struct access *access;
    struct store *store;
    struct memory memory;
    struct request_host requests;
    struct session_host sessions;
};

#endif
