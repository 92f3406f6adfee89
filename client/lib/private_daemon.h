/* A sheend of one's own: a child process that serves one socket and ends when it closes.
 *
 * The owner of the struct ends it with private_daemon_finish(), after closing the socket.
 * Thread: one at a time. Other children of the process are not touched. */
#ifndef SHEEN_CLIENT_PRIVATE_DAEMON_H
#define SHEEN_CLIENT_PRIVATE_DAEMON_H

#include <sys/types.h>

#include "client/lib/sheen.h"

struct private_daemon {
    pid_t pid;     /* 0: none, or reaped */
    int stderr_fd; /* a memory file with what it wrote to standard error; -1: none */
};

/* Starts `sheend --session-fd N` on `session_fd`, which stays the caller's: he closes it right
 * after. Device, threads and budget of memory, all of which is its one client's, are as *options
 * says. SHEEN_NO_SERVER when it cannot be started. */
enum sheen_status private_daemon_start(struct private_daemon *daemon, int session_fd,
                                       const struct sheen_connect_options *options,
                                       struct sheen_error *error);

/* Once the connection is lost: waits briefly for the daemon's end and puts why it ended into
 * *error (its last line on standard error, its signal or exit code). SHEEN_DEVICE_FAILED when it
 * ended with exit code 5, else `status`. Without a daemon *error stays as it is. */
enum sheen_status private_daemon_explain(struct private_daemon *daemon, enum sheen_status status,
                                         struct sheen_error *error);

/* Waits for the daemon to end, ends it by force after some seconds, and reaps it. */
void private_daemon_finish(struct private_daemon *daemon);

#endif
