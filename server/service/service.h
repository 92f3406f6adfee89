/* The daemon as a whole: device, threads, listeners, sessions, and their end.
 * Thread: the one that calls service_create() runs it; it becomes the loop's thread. */
#ifndef SHEEN_SERVICE_SERVICE_H
#define SHEEN_SERVICE_SERVICE_H

#include <stddef.h>

#include "protocol/address.h"
#include "server/error.h"
#include "server/gpu/renderer.h"
#include "server/service/limits.h"

#define SERVICE_MAX_LISTENERS 16

struct service_options {
    struct address listen[SERVICE_MAX_LISTENERS];
    size_t n_listen;
    int session_fd;     /* serve this connected socket alone; -1: listen */
    const char *device; /* as renderer_options.device */
    unsigned n_threads; /* of the pool, 1 to POOL_MAX_THREADS */
    struct limits limits;
};

struct service;

/* Opens the device, then the listeners. From here on SIGTERM and SIGINT are taken by the loop.
 * NULL on failure: ERROR_DEVICE without a device, ERROR_REQUEST for an address that may not be
 * listened on, else ERROR_SERVER. */
struct service *service_create(const struct service_options *options, struct error *error);
void service_destroy(struct service *service); /* NULL is safe */

/* Serves until SIGTERM or SIGINT (what is in flight is finished and sent; a second signal ends at
 * once), or until the one session has closed: then the process ends, if need be here and now. */
void service_run(struct service *service);

/* For the line at start-up: the device's name, and the listeners' addresses joined by ", ". */
const struct renderer_info *service_device(const struct service *service);
void service_addresses(const struct service *service, char *text, size_t capacity);

#endif
