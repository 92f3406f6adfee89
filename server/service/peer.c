#include "server/service/peer.h"

#include <netdb.h>
#include <netinet/in.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>

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
