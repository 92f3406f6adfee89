/* Another program of sheen as a child process, with one socket to its parent: a client starts
 * its private daemon by it.
 *
 * Thread: any; no other thread need hold still, since nothing of this process is changed. */
#ifndef SHEEN_PROTOCOL_CHILD_H
#define SHEEN_PROTOCOL_CHILD_H

#include <sys/types.h>

struct child_files {
    int socket_fd; /* the child's end, as numbered here; above socket_as */
    int socket_as; /* its number in the child, at least 3; all descriptors above it are closed there */
    int stderr_fd; /* standard error of the child, above socket_as here; -1: the parent's own */
};

/* Starts `path`, a bare name along the PATH, with argv, which ends with NULL, and this process's
 * environment. Standard input and output are /dev/null, no signal is blocked, and each does what it
 * does by default. 0, and *pid is set; else an errno value. The caller keeps its descriptors. */
int child_start(pid_t *pid, const char *path, const char *const argv[],
                const struct child_files *files);

#endif
