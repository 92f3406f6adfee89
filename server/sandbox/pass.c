#include "server/sandbox/pass.h"

#include <errno.h>
#include <string.h>
#include <sys/socket.h>

/* Aligned space for the descriptors of a message. */
union control {
    struct cmsghdr align;
    char bytes[CMSG_SPACE(PASS_MAX_FDS * sizeof(int))];
};

bool pass_send(int socket_fd, const void *message, size_t size, const int fds[], size_t n)
{
    union control control = {.bytes = {0}};
    const union {
        const void *in;
        void *out; /* for history's sake; nothing is written to it */
    } bytes = {.in = message};
    struct iovec vector = {bytes.out, size};
    struct msghdr header = {.msg_iov = &vector, .msg_iovlen = 1};
    if (n > 0) {
        header.msg_control = &control;
        header.msg_controllen = CMSG_SPACE(n * sizeof(int));
        struct cmsghdr *part = CMSG_FIRSTHDR(&header);
        part->cmsg_level = SOL_SOCKET;
        part->cmsg_type = SCM_RIGHTS;
        part->cmsg_len = CMSG_LEN(n * sizeof(int));
        memcpy(CMSG_DATA(part), fds, n * sizeof(int));
    }
    ssize_t sent;
    do
        sent = sendmsg(socket_fd, &header, MSG_NOSIGNAL);
    while (sent < 0 && errno == EINTR);
    return sent == (ssize_t)size;
}

ssize_t pass_receive(int socket_fd, void *message, size_t size, int fds[static PASS_MAX_FDS],
                     size_t *n)
{
    union control control;
    struct iovec vector = {message, size};
    struct msghdr header = {.msg_iov = &vector,
                            .msg_iovlen = 1,
                            .msg_control = &control,
                            .msg_controllen = sizeof control};
    *n = 0;
    ssize_t received;
    do
        received = recvmsg(socket_fd, &header, MSG_CMSG_CLOEXEC);
    while (received < 0 && errno == EINTR);
    const struct cmsghdr *part = received > 0 ? CMSG_FIRSTHDR(&header) : NULL;
    if (part && part->cmsg_level == SOL_SOCKET && part->cmsg_type == SCM_RIGHTS) {
        *n = (part->cmsg_len - CMSG_LEN(0)) / sizeof(int);
        memcpy(fds, CMSG_DATA(part), *n * sizeof(int));
    }
    return received;
}
