/* Sends and receives messages with descriptors over a SEQPACKET socket between processes of sheen.
 * Thread: any. */
#ifndef SHEEN_SANDBOX_PASS_H
#define SHEEN_SANDBOX_PASS_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

#define PASS_MAX_FDS 3

/* Sends a message with n descriptors, at most PASS_MAX_FDS, which the caller keeps. False with
 * errno. */
bool pass_send(int socket_fd, const void *message, size_t size, const int fds[], size_t n);

/* Receives a message of at most `size` bytes. Returns the message's size; 0 at the end of the
 * socket, -1 with errno. The descriptors that came are in fds, their number is in *n; the caller
 * owns them, and they are closed in programs that it starts. */
ssize_t pass_receive(int socket_fd, void *message, size_t size, int fds[static PASS_MAX_FDS],
                     size_t *n);

#endif
