/* The service manager's side of the daemon: sd_notify(3) and sd_listen_fds(3) by hand, which are a
 * datagram and two environment variables. Without a service manager these functions do nothing.
 * Thread: the loop's, and before it main's. */
#ifndef SHEEN_OPS_NOTIFY_H
#define SHEEN_OPS_NOTIFY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"

#define NOTIFY_MAX_FDS 32
#define NOTIFY_NAME_BYTES 64

/* Sends KEY=VALUE lines, as "READY=1" or "STOPPING=1\nSTATUS=draining", to $NOTIFY_SOCKET. Never
 * blocks; what cannot be sent is lost. */
void notify_send(const char *state);

/* How often the manager wants WATCHDOG=1, in microseconds; 0: it does not watch this process. */
uint64_t notify_watchdog_us(void);

/* Listening sockets that the manager has opened for this process, and their names there
 * (FileDescriptorName=). They become close-on-exec and the environment forgets them, so that only
 * the first call finds them. False when the environment makes no sense: ERROR_SERVER. */
struct notify_fds {
    size_t n;
    int fd[NOTIFY_MAX_FDS];
    char name[NOTIFY_MAX_FDS][NOTIFY_NAME_BYTES]; /* "": it has none */
};
bool notify_listen_fds(struct notify_fds *fds, struct error *error);

#endif
