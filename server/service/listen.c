#include "server/service/listen.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#define ACCEPTS_PER_EVENT 16

struct listener {
    struct loop *loop;
    struct loop_source source;
    int fd;
    bool paused;
    struct address address;
    struct stat file; /* of a Unix socket */
    char text[LISTENER_TEXT_BYTES];
    void (*accepted)(void *owner, int fd);
    void *owner;
};

/* --- addresses */

static bool is_loopback(const struct sockaddr *address)
{
    if (address->sa_family == AF_INET) {
        struct sockaddr_in v4;
        memcpy(&v4, address, sizeof v4);
        return ntohl(v4.sin_addr.s_addr) >> 24 == 127;
    }
    if (address->sa_family != AF_INET6)
        return false;
    struct sockaddr_in6 v6;
    memcpy(&v6, address, sizeof v6);
    return IN6_IS_ADDR_LOOPBACK(&v6.sin6_addr) ||
           (IN6_IS_ADDR_V4MAPPED(&v6.sin6_addr) && v6.sin6_addr.s6_addr[12] == 127);
}

static bool resolve(const struct address *address, struct addrinfo **found, struct error *error)
{
    char port[8];
    snprintf(port, sizeof port, "%u", (unsigned)address->port);
    const struct addrinfo hints = {.ai_family = AF_UNSPEC, .ai_socktype = SOCK_STREAM};
    int code = getaddrinfo(address->host, port, &hints, found);
    if (code)
        return error_set(error, ERROR_SERVER, "cannot find the address of '%s': %s", address->host,
                         gai_strerror(code));
    for (const struct addrinfo *a = *found; a; a = a->ai_next) {
        if (is_loopback(a->ai_addr))
            continue;
        freeaddrinfo(*found);
        return error_set(error, ERROR_REQUEST,
                         "tcp:%s:%u is not a loopback address: this version listens on TCP only "
                         "at 127.0.0.1 or [::1], because it has no TLS yet; tunnel to it with ssh",
                         address->host, (unsigned)address->port);
    }
    return true;
}

bool listener_check(const struct address *address, struct error *error)
{
    if (address->kind == ADDRESS_UNIX)
        return true;
    struct addrinfo *found;
    if (!resolve(address, &found, error))
        return false;
    freeaddrinfo(found);
    return true;
}

/* --- opening */

/* Does a daemon answer at this path? */
static bool is_alive(const struct sockaddr_un *name)
{
    int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (fd < 0)
        return true; /* unknown: leave it alone */
    bool alive = connect(fd, (const struct sockaddr *)name, sizeof *name) == 0 ||
                 (errno != ECONNREFUSED && errno != ENOENT);
    close(fd);
    return alive;
}

static bool remove_stale(const struct sockaddr_un *name, struct error *error)
{
    struct stat file;
    if (lstat(name->sun_path, &file) < 0)
        return errno == ENOENT || error_set(error, ERROR_SERVER, "cannot listen on unix:%s: %s",
                                            name->sun_path, strerror(errno));
    if (!S_ISSOCK(file.st_mode))
        return error_set(error, ERROR_SERVER,
                         "cannot listen on unix:%s: there is a file that is no socket",
                         name->sun_path);
    if (is_alive(name))
        return error_set(error, ERROR_SERVER,
                         "cannot listen on unix:%s: another daemon answers there", name->sun_path);
    if (unlink(name->sun_path) < 0 && errno != ENOENT)
        return error_set(error, ERROR_SERVER, "cannot remove the old socket %s: %s", name->sun_path,
                         strerror(errno));
    return true;
}

static bool open_unix(struct listener *listener, struct error *error)
{
    struct sockaddr_un name = {.sun_family = AF_UNIX};
    snprintf(name.sun_path, sizeof name.sun_path, "%s", listener->address.path);
    snprintf(listener->text, sizeof listener->text, "unix:%s", name.sun_path);
    if (!remove_stale(&name, error))
        return false;
    listener->fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    /* Linux gives the file the mode of the socket: it is never open to others, not for a moment. */
    if (listener->fd < 0 || fchmod(listener->fd, 0600) < 0 ||
        bind(listener->fd, (const struct sockaddr *)&name, sizeof name) < 0)
        return error_set(error, ERROR_SERVER, "cannot listen on %s: %s", listener->text,
                         strerror(errno));
    if (lstat(name.sun_path, &listener->file) < 0 || listen(listener->fd, SOMAXCONN) < 0)
        return error_set(error, ERROR_SERVER, "cannot listen on %s: %s", listener->text,
                         strerror(errno));
    return true;
}

static bool bind_tcp(struct listener *listener, const struct addrinfo *address)
{
    static const int on = 1;
    listener->fd = socket(address->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (listener->fd < 0)
        return false;
    setsockopt(listener->fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    if (bind(listener->fd, address->ai_addr, address->ai_addrlen) == 0 &&
        listen(listener->fd, SOMAXCONN) == 0)
        return true;
    int code = errno;
    close(listener->fd);
    listener->fd = -1;
    errno = code;
    return false;
}

static void describe_tcp(struct listener *listener)
{
    struct sockaddr_storage name;
    socklen_t size = sizeof name;
    char host[INET6_ADDRSTRLEN] = "?", port[8] = "?";
    if (getsockname(listener->fd, (struct sockaddr *)&name, &size) == 0)
        getnameinfo((struct sockaddr *)&name, size, host, sizeof host, port, sizeof port,
                    NI_NUMERICHOST | NI_NUMERICSERV);
    bool v6 = strchr(host, ':') != NULL;
    snprintf(listener->text, sizeof listener->text, v6 ? "tcp:[%s]:%s" : "tcp:%s:%s", host, port);
}

static bool open_tcp(struct listener *listener, struct error *error)
{
    struct addrinfo *found;
    if (!resolve(&listener->address, &found, error))
        return false;
    bool ok = false;
    for (const struct addrinfo *a = found; a && !ok; a = a->ai_next)
        ok = bind_tcp(listener, a);
    if (ok)
        describe_tcp(listener);
    else
        error_set(error, ERROR_SERVER, "cannot listen on tcp:%s:%u: %s", listener->address.host,
                  (unsigned)listener->address.port, strerror(errno));
    freeaddrinfo(found);
    return ok;
}

/* --- accepting */

/* False when there is nobody to accept now. */
static bool accept_one(struct listener *listener)
{
    int fd = accept4(listener->fd, NULL, NULL, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (fd < 0) {
        /* The connection stays in the queue and would wake the loop at once, again and again. */
        if (errno == EMFILE || errno == ENFILE || errno == ENOMEM || errno == ENOBUFS) {
            listener->paused = true;
            loop_unwatch(listener->loop, &listener->source);
        }
        return false;
    }
    /* What has not left for the network stays here, where a newer frame may still replace it. */
    static const int on = 1, most_unsent_bytes = 128 * 1024;
    if (listener->address.kind == ADDRESS_TCP) {
        setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
        setsockopt(fd, IPPROTO_TCP, TCP_NOTSENT_LOWAT, &most_unsent_bytes,
                   sizeof most_unsent_bytes);
    }
    listener->accepted(listener->owner, fd);
    return true;
}

static void listener_ready(struct loop_source *source, uint32_t events)
{
    (void)events;
    for (int i = 0; i < ACCEPTS_PER_EVENT && accept_one(source->owner); i++)
        ;
}

void listener_resume(struct listener *listener)
{
    listener->source.fd = listener->fd;
    listener->paused = !loop_watch(listener->loop, &listener->source, EPOLLIN, NULL);
}

bool listener_is_paused(const struct listener *listener)
{
    return listener->paused;
}

const char *listener_text(const struct listener *listener)
{
    return listener->text;
}

struct listener *listener_open(struct loop *loop, const struct address *address,
                               void (*accepted)(void *owner, int fd), void *owner,
                               struct error *error)
{
    struct listener *listener = calloc(1, sizeof *listener);
    if (!listener) {
        error_set(error, ERROR_SERVER, "no memory for a listener");
        return NULL;
    }
    *listener = (struct listener){.loop = loop,
                                  .source = {-1, listener_ready, listener},
                                  .fd = -1,
                                  .address = *address,
                                  .accepted = accepted,
                                  .owner = owner};
    bool ok =
        address->kind == ADDRESS_UNIX ? open_unix(listener, error) : open_tcp(listener, error);
    if (ok) {
        listener->source.fd = listener->fd;
        ok = loop_watch(loop, &listener->source, EPOLLIN, error);
    }
    if (!ok) {
        listener_close(listener);
        return NULL;
    }
    return listener;
}

void listener_close(struct listener *listener)
{
    if (!listener)
        return;
    loop_unwatch(listener->loop, &listener->source);
    struct stat file;
    const struct stat *ours = &listener->file;
    if (ours->st_ino != 0 && lstat(listener->address.path, &file) == 0 &&
        file.st_dev == ours->st_dev && file.st_ino == ours->st_ino)
        unlink(listener->address.path);
    if (listener->fd >= 0)
        close(listener->fd);
    free(listener);
}
