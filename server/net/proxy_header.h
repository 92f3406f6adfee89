/* The header of PROXY protocol version 2, in which a balancer says whose connection it hands on, and
 * from which addresses such a header is taken. Pure, any thread. */
#ifndef SHEEN_NET_PROXY_HEADER_H
#define SHEEN_NET_PROXY_HEADER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/socket.h>

#include "server/base/error.h"

#define PROXY_HEADER_FIXED_BYTES 16
#define PROXY_HEADER_MOST_BYTES 2048 /* with the fixed part; a longer one is refused */
#define PROXY_MAX_NETWORKS 16

/* The addresses of balancers. */
struct proxy_networks {
    size_t n;
    struct {
        uint8_t address[16]; /* IPv4 as ::ffff:a.b.c.d */
        unsigned bits;       /* of 128 */
    } network[PROXY_MAX_NETWORKS];
};

/* Adds "ADDRESS" or "ADDRESS/BITS". ERROR_REQUEST says what is wrong. */
bool proxy_networks_add(struct proxy_networks *networks, const char *text, struct error *error);
bool proxy_networks_hold(const struct proxy_networks *networks, const struct sockaddr *address);

/* The length of the whole header by its fixed part; 0 when it is none, or one that is not taken. */
size_t proxy_header_length(const uint8_t fixed[static PROXY_HEADER_FIXED_BYTES]);

/* Reads a whole header. *is_local: the balancer's own connection, or one of an address that it does not
 * tell; else the client's address is in *from. False when it is damaged. */
bool proxy_header_read(const uint8_t *header, size_t length, bool *is_local,
                       struct sockaddr_storage *from);

#endif
