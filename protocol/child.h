/* Another program of sheen as a child process, with one socket to its parent: a client starts
 * its private daemon by it.
 *
 * Thread: any. Other threads may run in the meantime: the descriptors and signals of this process do
 * not change. */
#ifndef SHEEN_PROTOCOL_CHILD_H
#define SHEEN_PROTOCOL_CHILD_H

#include <sys/types.h>

struct child_files {
    int socket_fd; /* the child's end, as numbered here; above socket_as */
    int socket_as; /* its number in the child, at least 3 */
    int stderr_fd; /* standard error of the child, above socket_as here; -1: the parent's own */
};

/* Starts the program `path` with argv, which ends with NULL, and this process's environment. A name
 * without '/' is looked up in PATH. In the child, standard input and output are /dev/null, all
 * descriptors above socket_as are closed, and all signals are unblocked and have their default
 * action. A descriptor from 3 to socket_as - 1 is inherited unless it is close-on-exec. Returns 0 and
 * sets *pid, or returns an errno value. The caller keeps its descriptors. */
int child_start(pid_t *pid, const char *path, const char *const argv[],
                const struct child_files *files);

#endif
