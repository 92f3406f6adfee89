/* Talks to the service manager (systemd): the protocols of sd_notify(3) and sd_listen_fds(3), which
 * are one datagram and a few environment variables. Without a service manager these functions do
 * nothing.
 * Thread: the loop's; before the loop runs, the main thread. */
#ifndef SHEEN_OPS_NOTIFY_H
#define SHEEN_OPS_NOTIFY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"

#define NOTIFY_MAX_FDS 32
#define NOTIFY_NAME_BYTES 64

/* Connects to $NOTIFY_SOCKET, once, since a confined daemon can open no socket. */
void notify_open(void);
/* Sends lines of KEY=VALUE, for example "READY=1" or "STOPPING=1\nSTATUS=draining". Never blocks. A
 * failure is ignored. */
void notify_send(const char *state);

/* The period within which the service manager expects WATCHDOG=1, in microseconds; 0: no
 * watchdog. */
uint64_t notify_watchdog_us(void);

/* Listening sockets that the service manager has opened for this process, with the names that it
 * gives them (FileDescriptorName=). */
struct notify_fds {
    size_t n;
    int fd[NOTIFY_MAX_FDS];
    char name[NOTIFY_MAX_FDS][NOTIFY_NAME_BYTES]; /* "": no name */
};
/* Gets the listening sockets and makes them close-on-exec. Removes the environment variables, so
 * that only the first call finds any; the caller owns the descriptors. False with ERROR_SERVER if
 * the variables are malformed. */
bool notify_listen_fds(struct notify_fds *fds, struct error *error);

#endif
