/* The daemon as a whole: service_create() opens the device, starts the threads and listens;
 * service_run() serves; service_destroy() frees everything.
 * Thread: the one that calls service_create(); it becomes the loop's thread. */
#ifndef SHEEN_OPS_SERVICE_H
#define SHEEN_OPS_SERVICE_H

#include <stddef.h>
#include <stdint.h>

#include "protocol/address.h"
#include "server/base/error.h"
#include "server/net/access.h"
#include "server/net/listen.h"
#include "server/net/proxy_header.h"
#include "server/ops/limits.h"
#include "server/base/log.h"

#define SERVICE_MAX_LISTENERS 16
#define SERVICE_DEVICE_BYTES 64
#define SERVICE_ISA_BYTES 8

struct service_listen {
    size_t n;
    struct address address[SERVICE_MAX_LISTENERS];
};

/* The options of the daemon. Plain data; zero the struct before filling it, because two of them are
 * compared byte by byte. */
struct service_options {
    struct service_listen listen;
    /* where health and metrics are served: none or one address */
    struct service_listen metrics;
    /* load balancers that announce client addresses by the PROXY protocol */
    struct proxy_networks proxy_from;
    bool metrics_open;                  /* metrics may be served beyond the loopback */
    int session_fd;                     /* serve only this connected socket; -1: listen */
    char device[SERVICE_DEVICE_BYTES];  /* as renderer_options.device */
    uint64_t n_native_threads;          /* as renderer_options.n_threads; not 0 */
    char native_isa[SERVICE_ISA_BYTES]; /* "auto", or as renderer_options.isa */
    uint64_t n_threads;                 /* threads of the pool, 1 to POOL_MAX_THREADS */
    struct limits limits;
    uint64_t stuck_s; /* seconds; as stuck_us of monitor_create() */
    struct access_options access;
    bool share_models; /* every client may use all uploaded files */
    /* folder of model files that clients may ask for by name; "": none */
    char models[ACCESS_PATH_BYTES];
    enum log_level log_level; /* a daemon with a single session logs only errors */
    enum log_format log_format;
};

/* Called on SIGHUP: reads the configuration again into *options, or returns false with the reason,
 * and the old configuration stays in force. */
struct service_reloader {
    bool (*read)(void *owner, struct service_options *options, struct error *error);
    void *owner;
};

/* Checks the options together and against the system: whether the addresses may be listened on, and
 * whether certificates and tokens are readable. ERROR_REQUEST for a bad option, ERROR_SERVER for an
 * unknown host. */
bool service_options_check(const struct service_options *options, struct error *error);

/* Which addresses may serve metrics without TLS. */
enum listener_reach service_metrics_reach(const struct service_options *options);

struct service;

/* Opens the device, then the listeners: the service manager's sockets if there are any, else those
 * of *options, else a default one for this user. From here on SIGTERM, SIGINT and SIGHUP go to the
 * event loop. Copies *options and *reloader. NULL on failure: ERROR_DEVICE without a usable device,
 * ERROR_REQUEST for an address that may not be listened on, else ERROR_SERVER. */
struct service *service_create(const struct service_options *options,
                               const struct service_reloader *reloader, struct error *error);
void service_destroy(struct service *service); /* NULL is safe */

/* Serves until one of these happens, and returns the exit code of the process:
 *
 * - SIGTERM or SIGINT: requests in flight are finished and sent for up to limits.session.drain_s
 *   seconds; the rest is then refused, and 4 s later the process exits even if threads are at work.
 *   A second signal ends the process at once.
 * - The only session of a private daemon has closed. The process may exit inside this call.
 * - The GPU was lost too often (limits.gpu_losses), or a process that starts worker programs has died: as
 *   after SIGTERM, with SERVICE_START_ANOTHER. The daemon itself may start no process any more. */
enum service_end { SERVICE_ENDED = 0, SERVICE_START_ANOTHER = 75 /* EX_TEMPFAIL */ };
enum service_end service_run(struct service *service);

#endif
