/* A private daemon: a sheend that runs as a child process, serves one socket and ends when that
 * closes.
 *
 * The owner of the struct closes the socket first, then calls private_daemon_finish(). Other
 * children of the process are not touched.
 * Thread: one at a time. */
#ifndef SHEEN_CLIENT_PRIVATE_DAEMON_H
#define SHEEN_CLIENT_PRIVATE_DAEMON_H

#include <sys/types.h>

#include "client/lib/sheen.h"

struct private_daemon {
    pid_t pid;     /* 0: none, or already reaped */
    int stderr_fd; /* memory file with the daemon's standard error; -1: none */
};

/* Starts `sheend --session-fd N` with a copy of `session_fd`; the caller closes its own after the
 * call. *options has the device, the threads and the memory budget, all of which is for this one
 * client. SHEEN_NO_SERVER if it cannot be started. */
enum sheen_status private_daemon_start(struct private_daemon *daemon, int session_fd,
                                       const struct sheen_connect_options *options,
                                       struct sheen_error *error);

/* Call it when the connection is lost: waits briefly for the daemon to end and writes the reason to
 * *error (its last line on standard error, its signal or exit code). Returns SHEEN_DEVICE_FAILED if
 * it ended with exit code 5, else `status`. Without a private daemon *error is unchanged. */
enum sheen_status private_daemon_explain(struct private_daemon *daemon, enum sheen_status status,
                                         struct sheen_error *error);

/* Waits for the daemon to end, kills it after some seconds, and reaps it. */
void private_daemon_finish(struct private_daemon *daemon);

#endif
