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

/* Receives a message of at most `size` bytes; of a longer message the rest is lost. Returns the number
 * of bytes received; 0 if the other side has closed the socket (or has sent an empty message, which
 * no process of sheen does); -1 with errno. The descriptors that came are in fds, their number is in
 * *n. The caller owns them; they are close-on-exec. */
ssize_t pass_receive(int socket_fd, void *message, size_t size, int fds[static PASS_MAX_FDS],
                     size_t *n);

#endif
