/* Parses the address of a daemon:
 *
 *   unix:PATH          a Unix socket, PATH up to 107 bytes
 *   tcp:HOST:PORT      HOST is an IPv4 address, a name, or an IPv6 address in brackets: tcp:[::1]:7410
 *   tls:HOST:PORT      the same, with TLS 1.3
 *
 * Nothing is resolved or opened. Pure, any thread. */
#ifndef SHEEN_PROTOCOL_ADDRESS_H
#define SHEEN_PROTOCOL_ADDRESS_H

#include <stdbool.h>
#include <stdint.h>

#define ADDRESS_PATH_BYTES 108 /* sockaddr_un.sun_path, with its 0 */
#define ADDRESS_HOST_BYTES 254 /* a DNS name is at most 253 */
#define ADDRESS_TEXT_BYTES 480 /* of an error text, with its 0 */

enum address_kind { ADDRESS_UNIX, ADDRESS_TCP, ADDRESS_TLS };

struct address {
    enum address_kind kind;
    char path[ADDRESS_PATH_BYTES]; /* ADDRESS_UNIX: not empty, no control character */
    char host[ADDRESS_HOST_BYTES]; /* TCP and TLS: without brackets; for getaddrinfo() */
    uint16_t port;                 /* TCP and TLS; 0: the system chooses (listeners only) */
};

/* "unix", "tcp" or "tls". */
const char *address_scheme(enum address_kind kind);

/* Parses `text` into *address. On failure returns false and writes one line to error_text, which
 * says what is wrong and what an address looks like; *address is then undefined. */
bool address_parse(struct address *address, const char *text,
                   char error_text[static ADDRESS_TEXT_BYTES]);

#endif
