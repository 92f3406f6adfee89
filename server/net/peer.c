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

/* Fills in name and key of a zeroed peer. */
static void identify(struct peer *peer, int fd)
{
    struct sockaddr_storage name = {0};
    socklen_t size = sizeof name;
    struct ucred user;
    socklen_t user_size = sizeof user;
    snprintf(peer->name, sizeof peer->name, "unknown");
    if (getpeername(fd, (struct sockaddr *)&name, &size) < 0)
        return;
    if (name.ss_family == AF_UNIX) {
        if (getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &user, &user_size) < 0)
            return;
        snprintf(peer->name, sizeof peer->name, "user %lu", (unsigned long)user.uid);
        peer->key[0] = 1;
        peer->key[1] = user.uid;
    } else if (name.ss_family == AF_INET6) {
        struct sockaddr_in6 v6;
        memcpy(&v6, &name, sizeof v6);
        identify_v6(peer, &v6.sin6_addr);
    } else if (name.ss_family == AF_INET) {
        struct sockaddr_in v4;
        memcpy(&v4, &name, sizeof v4);
        inet_ntop(AF_INET, &v4.sin_addr, peer->name, sizeof peer->name);
        peer->key[0] = 2;
        peer->key[1] = v4.sin_addr.s_addr;
    }
}

struct peer peer_identify(int fd)
{
    struct peer peer = {0};
    identify(&peer, fd);
    return peer;
}

void peer_describe(int fd, char text[static PEER_TEXT_BYTES])
{
    struct ucred credentials;
    struct sockaddr_storage name;
    socklen_t size = sizeof name, credentials_size = sizeof credentials;
    char host[INET6_ADDRSTRLEN + 16], port[8];
    snprintf(text, PEER_TEXT_BYTES, "unknown");
    if (getpeername(fd, (struct sockaddr *)&name, &size) < 0)
        return;
    if (name.ss_family == AF_UNIX) {
        if (getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &credentials, &credentials_size) == 0)
            snprintf(text, PEER_TEXT_BYTES, "unix uid=%lu gid=%lu pid=%ld",
                     (unsigned long)credentials.uid, (unsigned long)credentials.gid,
                     (long)credentials.pid);
    } else if (getnameinfo((const struct sockaddr *)&name, size, host, sizeof host, port,
                           sizeof port, NI_NUMERICHOST | NI_NUMERICSERV) == 0) {
        bool v6 = strchr(host, ':') != NULL;
        snprintf(text, PEER_TEXT_BYTES, v6 ? "[%s]:%s" : "%s:%s", host, port);
    }
}
