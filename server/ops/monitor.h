/* What watches the daemon while it serves: the service manager's watchdog, fed only while the GL
 * thread, the pool and the readers are well, and health and metrics over HTTP. Thread: the loop's.
 */
#ifndef SHEEN_OPS_MONITOR_H
#define SHEEN_OPS_MONITOR_H

#include "protocol/address.h"
#include "server/net/listen.h"
#include "server/ops/daemon.h"

struct monitor;

/* stuck_us: a thread that is at one piece of work for longer is taken for stuck. *daemon and what it
 * names stay until monitor_destroy(). */
struct monitor *monitor_create(const struct daemon *daemon, uint64_t stuck_us, struct error *error);
void monitor_destroy(struct monitor *monitor); /* NULL is safe */

/* Serves GET /metrics, /healthz and /readyz at this address, or on a listening socket of the
 * service manager's, which it closes on failure: Unix, or TCP within `reach`, without TLS. */
bool monitor_listen(struct monitor *monitor, const struct address *address,
                    enum listener_reach reach, struct error *error);
bool monitor_adopt(struct monitor *monitor, int fd, enum listener_reach reach, struct error *error);
/* The address that is served; "" when there is none. */
const char *monitor_address(const struct monitor *monitor);

void monitor_set_stuck(struct monitor *monitor, uint64_t stuck_us);

#endif
