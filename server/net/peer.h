/* Who is at the other end of a connected socket. Any thread; the kernel is asked each time. */
#ifndef SHEEN_NET_PEER_H
#define SHEEN_NET_PEER_H

#include <stdint.h>

#define PEER_NAME_BYTES 64
#define PEER_TEXT_BYTES 80

/* Connections of one user of the Unix socket, or from one address (of IPv6 its /64, which one
 * machine has to itself), have equal keys. */
struct peer {
    char name[PEER_NAME_BYTES]; /* "user 1000", "127.0.0.1"; "unknown" when the peer has gone */
    uint64_t key[2];            /* of all unknown peers the same */
};

struct peer peer_identify(int fd);

/* Who it is just now, for the log: "unix uid=1000 gid=1000 pid=42", or "192.0.2.1:4711"; "unknown"
 * when the peer has gone. */
void peer_describe(int fd, char text[static PEER_TEXT_BYTES]);

#endif
