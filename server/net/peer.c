#include "server/net/peer.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>

static void identify_v6(struct peer *peer, const struct in6_addr *address)
{
    struct in6_addr network = *address;
    bool is_v4 = IN6_IS_ADDR_V4MAPPED(address);
    if (!is_v4)
        memset(network.s6_addr + 8, 0, 8);
    memcpy(peer->key, network.s6_addr, sizeof peer->key);
    char text[INET6_ADDRSTRLEN] = "?";
    inet_ntop(AF_INET6, &network, text, sizeof text);
    snprintf(peer->name, sizeof peer->name, is_v4 ? "%s" : "%s/64", text);
}

struct peer peer_of_address(const struct sockaddr *address)
{
    struct peer peer = {0};
    snprintf(peer.name, sizeof peer.name, "unknown");
    if (address->sa_family == AF_INET6) {
        struct sockaddr_in6 v6;
        memcpy(&v6, address, sizeof v6);
        identify_v6(&peer, &v6.sin6_addr);
    } else if (address->sa_family == AF_INET) {
        struct sockaddr_in v4;
        memcpy(&v4, address, sizeof v4);
        inet_ntop(AF_INET, &v4.sin_addr, peer.name, sizeof peer.name);
        peer.key[0] = 2;
        peer.key[1] = v4.sin_addr.s_addr;
    }
    return peer;
}

bool peer_address(int fd, struct sockaddr_storage *address)
{
    socklen_t size = sizeof *address;
    *address = (struct sockaddr_storage){.ss_family = AF_UNSPEC};
    return getpeername(fd, (struct sockaddr *)address, &size) == 0;
}

void peer_describe_address(const struct sockaddr *address, char text[static PEER_TEXT_BYTES])
{
    char host[INET6_ADDRSTRLEN + 16], port[8];
    socklen_t size =
        address->sa_family == AF_INET6 ? sizeof(struct sockaddr_in6) : sizeof(struct sockaddr_in);
    snprintf(text, PEER_TEXT_BYTES, "unknown");
    if (getnameinfo(address, size, host, sizeof host, port, sizeof port,
                    NI_NUMERICHOST | NI_NUMERICSERV) == 0) {
        bool v6 = strchr(host, ':') != NULL;
        snprintf(text, PEER_TEXT_BYTES, v6 ? "[%s]:%s" : "%s:%s", host, port);
    }
}

void peer_describe(int fd, char text[static PEER_TEXT_BYTES])
{
    struct ucred credentials;
    struct sockaddr_storage address;
    socklen_t size = sizeof credentials;
    snprintf(text, PEER_TEXT_BYTES, "unknown");
    if (!peer_address(fd, &address))
        return;
    if (address.ss_family != AF_UNIX)
        peer_describe_address((const struct sockaddr *)&address, text);
    else if (getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &credentials, &size) == 0)
        snprintf(text, PEER_TEXT_BYTES, "unix uid=%lu gid=%lu pid=%ld",
                 (unsigned long)credentials.uid, (unsigned long)credentials.gid,
                 (long)credentials.pid);
}
