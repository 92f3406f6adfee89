/* Starts one worker program, again whenever it has died. A small process of its own does it, which
 * is forked before the daemon has threads: so the daemon itself may give up the right to start
 * programs and to signal processes (sandbox/confine.h), and whoever takes the daemon over can start
 * nothing but this program.
 *
 * Thread: one at a time. */
#ifndef SHEEN_THREADS_STARTER_H
#define SHEEN_THREADS_STARTER_H

#include "server/base/error.h"

struct starter;

/* Makes the process that will start the program at `path`. Call it before other threads run, since
 * it forks. NULL with ERROR_SERVER. */
struct starter *starter_create(const char *path, struct error *error);
/* Starts the program, after it has killed the one that was started before. The program gets
 * socket_fd as ZYGOTE_FD; the caller keeps its own. 0 or an errno value; ECHILD when the starter's
 * process has died. */
int starter_start(struct starter *starter, int socket_fd);
/* Kills the program, if there is one, and waits for its end. */
void starter_stop(struct starter *starter);
/* Kills the program and ends the starter's process. NULL is safe. */
void starter_destroy(struct starter *starter);

#endif
