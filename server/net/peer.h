/* Identifies the peer of a connected socket. Any thread; each call asks the kernel. */
#ifndef SHEEN_NET_PEER_H
#define SHEEN_NET_PEER_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/socket.h>

#define PEER_NAME_BYTES 64
#define PEER_TEXT_BYTES 80

/* An address; of an IPv6 address only its /64 network, which usually belongs to one machine.
 * Connections from the same address have the same key. */
struct peer {
    char name[PEER_NAME_BYTES]; /* "127.0.0.1", "2001:db8::/64" */
    uint64_t key[2];            /* all unknown addresses have the same key */
};

struct peer peer_of_address(const struct sockaddr *address);

/* The address of the socket's peer. False when the peer has gone. */
bool peer_address(int fd, struct sockaddr_storage *address);

/* Describes the peer for the log: "unix uid=1000 gid=1000 pid=42" or "192.0.2.1:4711"; "unknown"
 * when the peer has gone. */
void peer_describe(int fd, char text[static PEER_TEXT_BYTES]);
void peer_describe_address(const struct sockaddr *address, char text[static PEER_TEXT_BYTES]);

#endif
