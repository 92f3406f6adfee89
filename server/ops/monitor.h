/* Watches the daemon while it serves. The monitor feeds the service manager's watchdog as long as
 * the render thread, the compiler of shaders, the pool and the readers make progress, and it serves
 * health and metrics over HTTP.
 * Thread: the one that runs the loop (server/net/loop.h). */
#ifndef SHEEN_OPS_MONITOR_H
#define SHEEN_OPS_MONITOR_H

#include "protocol/address.h"
#include "server/net/listen.h"
#include "server/ops/daemon.h"

struct monitor;

/* A thread that works on one task for longer than stuck_us counts as stuck. *daemon and everything
 * that it points to must stay valid until monitor_destroy(). NULL with ERROR_SERVER on failure. */
struct monitor *monitor_create(struct daemon *daemon, uint64_t stuck_us, struct error *error);
void monitor_destroy(struct monitor *monitor); /* NULL is safe */

/* Serves GET /metrics, /healthz and /readyz without TLS: on a Unix socket, or on a TCP address
 * within `reach`. monitor_listen() opens the address; monitor_adopt() takes over `fd`, a listening
 * socket that the service manager has opened, and closes it on failure. */
bool monitor_listen(struct monitor *monitor, const struct address *address,
                    enum listener_reach reach, struct error *error);
bool monitor_adopt(struct monitor *monitor, int fd, enum listener_reach reach, struct error *error);
/* The address that is served; "" if none is. */
const char *monitor_address(const struct monitor *monitor);

/* Can a worker program not be started any more? Looked at about once a second. */
bool monitor_has_lost_workers(const struct monitor *monitor);
/* Limits the HTTP connections to `most` at the same time, 1 to HTTP_MAX_CONNECTIONS (http_limit());
 * without an address it does nothing. */
void monitor_limit(struct monitor *monitor, unsigned most);
/* Changes stuck_us of monitor_create(). */
void monitor_set_stuck(struct monitor *monitor, uint64_t stuck_us);

#endif
