/* Parses the header of the PROXY protocol, version 2, by which a load balancer announces whose
 * connection it passes on, and keeps the list of balancers that may do so. Pure, any thread. */
#ifndef SHEEN_NET_PROXY_HEADER_H
#define SHEEN_NET_PROXY_HEADER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/socket.h>

#include "server/base/error.h"

#define PROXY_HEADER_FIXED_BYTES 16
#define PROXY_HEADER_MOST_BYTES 2048 /* including the fixed part; longer headers are refused */
#define PROXY_MAX_NETWORKS 16

/* The addresses of balancers. */
struct proxy_networks {
    size_t n;
    struct {
        uint8_t address[16]; /* IPv4 as ::ffff:a.b.c.d */
        unsigned bits;       /* prefix length, 0 to 128 */
    } network[PROXY_MAX_NETWORKS];
};

/* Adds a network: "ADDRESS" or "ADDRESS/BITS". False with ERROR_REQUEST and the reason. */
bool proxy_networks_add(struct proxy_networks *networks, const char *text, struct error *error);
bool proxy_networks_hold(const struct proxy_networks *networks, const struct sockaddr *address);

/* The length of the whole header, read from its fixed part; 0 if it is not a header or not
 * accepted. */
size_t proxy_header_length(const uint8_t fixed[static PROXY_HEADER_FIXED_BYTES]);

/* Reads a whole header. Sets *is_local if the connection is the balancer's own, or if the header
 * tells no address; else *from is the client's address. False if the header is malformed. */
bool proxy_header_read(const uint8_t *header, size_t length, bool *is_local,
                       struct sockaddr_storage *from);

#endif
