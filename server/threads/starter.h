/* Starts and stops one worker program, for threads/worker.c. A starter does not watch the program: if
 * the program has died, it is started again only by the next starter_start().
 *
 * A starter has a small process of its own (`sheend-starter`) that starts the program. This process
 * is forked before the daemon has threads. So the daemon itself may give up the right to start
 * programs and to signal processes (sandbox/confine.h), and an attacker who controls the daemon can
 * start nothing but this program.
 *
 * Thread: any, but only one call at a time for each starter. */
#ifndef SHEEN_THREADS_STARTER_H
#define SHEEN_THREADS_STARTER_H

#include <stdbool.h>

#include "server/base/error.h"

struct starter;

/* Makes the process that will start the program at `path`. Call it before other threads run, since
 * it forks. NULL with ERROR_SERVER. It does not look for the program: if there is none,
 * starter_start() fails. */
struct starter *starter_create(const char *path, struct error *error);
/* Starts the program. If the program of an earlier call still runs, kills it first. The program gets
 * socket_fd as ZYGOTE_FD; the caller keeps its own descriptor. Returns 0 when the program runs, else
 * an errno value: ENOENT if there is no such program, ECHILD if the starter's process has died or does
 * not answer. */
int starter_start(struct starter *starter, int socket_fd);
/* Kills the program, if it runs, and waits for its end. Reports no failure: if the starter's process
 * has died, nothing is killed, and the program ends by itself when the daemon closes its socket. */
void starter_stop(struct starter *starter);
/* False if the starter's process has died, or has not answered a request: then the program cannot be started again. */
bool starter_is_alive(const struct starter *starter);
/* Kills the program and ends the starter's process. NULL is safe. */
void starter_destroy(struct starter *starter);

#endif
