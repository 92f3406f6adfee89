#include "server/net/proxy_header.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/number.h"

static const uint8_t SIGNATURE[12] = {0x0d, 0x0a, 0x0d, 0x0a, 0x00, 0x0d,
                                      0x0a, 0x51, 0x55, 0x49, 0x54, 0x0a};
static const uint8_t V4_IN_V6[12] = {[10] = 0xff, [11] = 0xff};

bool proxy_networks_add(struct proxy_networks *networks, const char *text, struct error *error)
{
    char address[INET6_ADDRSTRLEN];
    const char *slash = strchr(text, '/');
    size_t length = slash ? (size_t)(slash - text) : strlen(text);
    uint64_t bits = 0;
    if (networks->n == PROXY_MAX_NETWORKS)
        return error_set(error, ERROR_REQUEST, "at most %d networks of balancers may be listed",
                         PROXY_MAX_NETWORKS);
    uint8_t *to = networks->network[networks->n].address;
    snprintf(address, sizeof address, "%.*s", (int)length, text);
    bool fits = length < sizeof address, is_v4 = fits && inet_pton(AF_INET, address, to + 12) == 1;
    unsigned most = is_v4 ? 32 : 128;
    if (is_v4)
        memcpy(to, V4_IN_V6, sizeof V4_IN_V6);
    if (!is_v4 && !(fits && inet_pton(AF_INET6, address, to) == 1))
        return error_set(error, ERROR_REQUEST,
                         "'%s' is no address or network: as 10.0.0.7, 10.0.0.0/24 or fd00::/64",
                         text);
    if (slash && !number_parse(slash + 1, 0, most, false, &bits))
        return error_set(error, ERROR_REQUEST, "'%s': behind the / must be a number from 0 to %u",
                         text, most);
    networks->network[networks->n++].bits = 128 - most + (slash ? (unsigned)bits : most);
    return true;
}

static bool to_v6(const struct sockaddr *address, uint8_t v6[static 16])
{
    if (address->sa_family == AF_INET) {
        struct sockaddr_in in;
        memcpy(&in, address, sizeof in);
        memcpy(v6, V4_IN_V6, sizeof V4_IN_V6);
        memcpy(v6 + 12, &in.sin_addr, 4);
        return true;
    }
    if (address->sa_family != AF_INET6)
        return false;
    struct sockaddr_in6 in6;
    memcpy(&in6, address, sizeof in6);
    memcpy(v6, &in6.sin6_addr, 16);
    return true;
}

bool proxy_networks_hold(const struct proxy_networks *networks, const struct sockaddr *address)
{
    uint8_t v6[16];
    if (!to_v6(address, v6))
        return false;
    for (size_t i = 0; i < networks->n; i++) {
        const uint8_t *network = networks->network[i].address;
        unsigned bits = networks->network[i].bits, whole = bits / 8, rest = bits % 8;
        if (memcmp(network, v6, whole) == 0 &&
            (rest == 0 || (network[whole] ^ v6[whole]) >> (8 - rest) == 0))
            return true;
    }
    return false;
}

size_t proxy_header_length(const uint8_t fixed[static PROXY_HEADER_FIXED_BYTES])
{
    size_t length = PROXY_HEADER_FIXED_BYTES + ((size_t)fixed[14] << 8 | fixed[15]);
    bool is_known = memcmp(fixed, SIGNATURE, sizeof SIGNATURE) == 0 && fixed[12] >> 4 == 2 &&
                    (fixed[12] & 15) <= 1;
    return is_known && length <= PROXY_HEADER_MOST_BYTES ? length : 0;
}

bool proxy_header_read(const uint8_t *header, size_t length, bool *is_local,
                       struct sockaddr_storage *from)
{
    const uint8_t *at = header + PROXY_HEADER_FIXED_BYTES;
    const size_t left = length - PROXY_HEADER_FIXED_BYTES;
    *is_local = (header[12] & 15) == 0;
    *from = (struct sockaddr_storage){.ss_family = AF_UNSPEC};
    if (*is_local)
        return true;
    if (header[13] == 0x11) { /* TCP over IPv4: two addresses, two ports */
        struct sockaddr_in in = {.sin_family = AF_INET};
        if (left < 12)
            return false;
        memcpy(&in.sin_addr, at, 4);
        memcpy(&in.sin_port, at + 8, 2);
        memcpy(from, &in, sizeof in);
    } else if (header[13] == 0x21) {
        struct sockaddr_in6 in6 = {.sin6_family = AF_INET6};
        if (left < 36)
            return false;
        memcpy(&in6.sin6_addr, at, 16);
        memcpy(&in6.sin6_port, at + 32, 2);
        memcpy(from, &in6, sizeof in6);
    } else {
        *is_local = true; /* no address, or one of another kind */
    }
    return true;
}
