/* The daemon as a whole: device, threads, listeners, sessions, and their end.
 * Thread: the one that calls service_create() runs it; it becomes the loop's thread. */
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

/* Plain data, zeroed before it is filled, so that two can be compared byte by byte. */
struct service_options {
    struct service_listen listen;
    struct service_listen metrics;      /* of health and metrics: none or one */
    struct proxy_networks proxy_from;   /* balancers, which tell their clients' addresses */
    bool metrics_open;                  /* they may be beyond the loopback */
    int session_fd;                     /* serve this connected socket alone; -1: listen */
    char device[SERVICE_DEVICE_BYTES];  /* as renderer_options.device */
    uint64_t n_native_threads;          /* as renderer_options.n_threads, not 0 */
    char native_isa[SERVICE_ISA_BYTES]; /* "auto", or as renderer_options.isa */
    uint64_t n_threads;                 /* of the pool, 1 to POOL_MAX_THREADS */
    struct limits limits;
    uint64_t stuck_s; /* as monitor_create() */
    struct access_options access;
    bool share_models;              /* all uploads are everybody's */
    char models[ACCESS_PATH_BYTES]; /* folder of model files that clients may name; "": none */
    enum log_level log_level;       /* with a single session: errors only */
    enum log_format log_format;
};

/* SIGHUP asks for the configuration anew: fills *options, or says why the old one stays. */
struct service_reloader {
    bool (*read)(void *owner, struct service_options *options, struct error *error);
    void *owner;
};

/* What no single option can know, and what they name in the system: addresses that may be listened
 * on, certificates, tokens. ERROR_REQUEST, or ERROR_SERVER for a host that is not known. */
bool service_options_check(const struct service_options *options, struct error *error);

/* Where metrics may be listened for without TLS. */
enum listener_reach service_metrics_reach(const struct service_options *options);

struct service;

/* Opens the device, then the listeners: those of the service manager, or else those of *options, or
 * else one for this user alone. From here on SIGTERM, SIGINT and SIGHUP are taken by the loop.
 * NULL on failure: ERROR_DEVICE without a device, ERROR_REQUEST for an address that may not be
 * listened on, else ERROR_SERVER. */
struct service *service_create(const struct service_options *options,
                               const struct service_reloader *reloader, struct error *error);
void service_destroy(struct service *service); /* NULL is safe */

/* Serves until SIGTERM or SIGINT (what is in flight is finished and sent, for limits.drain_s; the
 * rest is refused, and 4 s later the process ends whatever its threads do; a second signal ends it
 * at once), or until the one session has closed: then the process ends, if need be here and now. It
 * also ends, as after SIGTERM, once the GPU has been lost too often (limits.gpu_losses). Returns
 * the process's exit code. */
enum service_end { SERVICE_ENDED = 0, SERVICE_GPU_LOST = 75 /* EX_TEMPFAIL: start another */ };
enum service_end service_run(struct service *service);

#endif
