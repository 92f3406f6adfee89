#include "server/net/listen.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
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

#include "server/base/fault.h"
#include "server/base/log.h"

#define ACCEPTS_PER_EVENT 16

struct listener {
    struct loop *loop;
    struct loop_source source;
    int fd;
    bool paused;
    bool is_short; /* accept() failed for lack of descriptors or memory */
    struct address address;
    struct stat file; /* identifies the file of a Unix socket */
    char text[LISTENER_TEXT_BYTES];
    struct listener_handler handler;
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

static bool resolve(const struct address *address, enum listener_reach reach,
                    struct addrinfo **found, struct error *error)
{
    char port[8];
    snprintf(port, sizeof port, "%u", (unsigned)address->port);
    const struct addrinfo hints = {.ai_family = AF_UNSPEC, .ai_socktype = SOCK_STREAM};
    int code = getaddrinfo(address->host, port, &hints, found);
    if (code)
        return error_set(error, ERROR_SERVER, "cannot find the address of '%s': %s", address->host,
                         gai_strerror(code));
    for (const struct addrinfo *a = *found; a; a = a->ai_next) {
        if (address->kind == ADDRESS_TLS || reach == LISTENER_ANYWHERE || is_loopback(a->ai_addr))
            continue;
        freeaddrinfo(*found);
        return error_set(error, ERROR_REQUEST,
                         "tcp:%s:%u is not a loopback address, and everybody on the way could read "
                         "and change what is sent: use tls:%s:%u with --tls-cert, --tls-key and "
                         "--client-ca or --tokens",
                         address->host, (unsigned)address->port, address->host,
                         (unsigned)address->port);
    }
    return true;
}

bool listener_check(const struct address *address, enum listener_reach reach, struct error *error)
{
    if (address->kind == ADDRESS_UNIX)
        return true;
    struct addrinfo *found;
    if (!resolve(address, reach, &found, error))
        return false;
    freeaddrinfo(found);
    return true;
}

/* If the system made no runtime folder for this user, uses a folder below /tmp, where somebody else
 * may have made something of the same name. */
bool listener_default(struct address *address, struct error *error)
{
    char folder[512], text[sizeof folder + 32], why[ADDRESS_TEXT_BYTES];
    const char *runtime = getenv("XDG_RUNTIME_DIR");
    if (runtime && runtime[0] == '/') {
        snprintf(folder, sizeof folder, "%s", runtime);
    } else {
        struct stat file;
        snprintf(folder, sizeof folder, "/tmp/sheen-%lu", (unsigned long)getuid());
        if (mkdir(folder, 0700) < 0 && errno != EEXIST)
            return error_set(error, ERROR_SERVER, "cannot make %s: %s", folder, strerror(errno));
        if (lstat(folder, &file) < 0 || !S_ISDIR(file.st_mode) || file.st_uid != getuid() ||
            (file.st_mode & 077) != 0)
            return error_set(error, ERROR_SERVER,
                             "%s is not a directory of yours alone: remove it, or use --listen",
                             folder);
    }
    snprintf(text, sizeof text, "unix:%s/sheen.sock", folder);
    return address_parse(address, text, why) || error_set(error, ERROR_REQUEST, "%s", why);
}

/* --- opening */

/* True if a daemon answers at this path. */
static bool is_alive(const struct sockaddr_un *name)
{
    int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (fd < 0)
        return true; /* unknown: keep the file */
    bool alive = connect(fd, (const struct sockaddr *)name, sizeof *name) == 0 ||
                 (errno != ECONNREFUSED && errno != ENOENT);
    close(fd);
    return alive;
}

/* Waits longer each time, 1.3 s altogether, for a predecessor that has been killed and still has the address
 * while it dies. False once that time is over. */
static bool wait_for_predecessor(unsigned *n_waits)
{
    enum { FIRST_WAIT_US = 20000, MOST_WAITS = 6 };
    if (*n_waits == MOST_WAITS)
        return false;
    usleep(FIRST_WAIT_US << (*n_waits)++);
    return true;
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
    unsigned n_waits = 0;
    while (is_alive(name))
        if (!wait_for_predecessor(&n_waits))
            return error_set(error, ERROR_SERVER,
                             "cannot listen on unix:%s: another daemon answers there",
                             name->sun_path);
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
    /* On Linux the file gets the mode of the socket, so it is never open to others. */
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

static void describe_tcp(struct listener *listener, const struct sockaddr *name, socklen_t size)
{
    char host[INET6_ADDRSTRLEN] = "?", port[8] = "?";
    getnameinfo(name, size, host, sizeof host, port, sizeof port, NI_NUMERICHOST | NI_NUMERICSERV);
    bool v6 = strchr(host, ':') != NULL;
    snprintf(listener->text, sizeof listener->text, v6 ? "%s:[%s]:%s" : "%s:%s:%s",
             address_scheme(listener->address.kind), host, port);
}

static bool open_tcp(struct listener *listener, enum listener_reach reach, struct error *error)
{
    struct addrinfo *found;
    if (!resolve(&listener->address, reach, &found, error))
        return false;
    bool ok = false;
    unsigned n_waits = 0;
    do
        for (const struct addrinfo *a = found; a && !ok; a = a->ai_next)
            ok = bind_tcp(listener, a);
    while (!ok && errno == EADDRINUSE && wait_for_predecessor(&n_waits));
    struct sockaddr_storage name = {0};
    socklen_t size = sizeof name;
    if (ok && getsockname(listener->fd, (struct sockaddr *)&name, &size) == 0)
        describe_tcp(listener, (const struct sockaddr *)&name, size);
    else
        error_set(error, ERROR_SERVER, "cannot listen on %s:%s:%u: %s",
                  address_scheme(listener->address.kind), listener->address.host,
                  (unsigned)listener->address.port, strerror(errno));
    freeaddrinfo(found);
    return ok;
}

/* --- accepting */

/* Pauses accepting: the connection stays in the queue and would wake the loop again and again. */
static void pause_for(struct listener *listener, int code)
{
    listener->paused = true;
    loop_unwatch(listener->loop, &listener->source);
    if (!listener->is_short)
        log_event(LOG_ERROR, "cannot accept clients: those who come wait",
                  log_text("listener", listener->text), log_text("text", strerror(code)));
    listener->is_short = true;
}

static int accept_fd(const struct listener *listener)
{
    if (!fault_at("accept.emfile"))
        return accept4(listener->fd, NULL, NULL, SOCK_CLOEXEC | SOCK_NONBLOCK);
    errno = EMFILE;
    return -1;
}

/* Accepts one connection; false if none waits. */
static bool accept_one(struct listener *listener)
{
    int fd = accept_fd(listener);
    if (fd < 0) {
        if (errno == EMFILE || errno == ENFILE || errno == ENOMEM || errno == ENOBUFS)
            pause_for(listener, errno);
        return false;
    }
    if (listener->is_short)
        log_event(LOG_INFO, "accepting clients again", log_text("listener", listener->text));
    listener->is_short = false;
    /* Limits the unsent bytes in the kernel: a frame that is still in the daemon can be replaced by
     * a newer one. */
    static const int on = 1, most_unsent_bytes = 128 * 1024;
    if (listener->address.kind != ADDRESS_UNIX) {
        setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
        setsockopt(fd, IPPROTO_TCP, TCP_NOTSENT_LOWAT, &most_unsent_bytes,
                   sizeof most_unsent_bytes);
    }
    listener->handler.accepted(listener->handler.owner, listener, fd);
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

static struct listener *create(struct loop *loop, int fd, const struct listener_handler *handler,
                               struct error *error)
{
    struct listener *listener = calloc(1, sizeof *listener);
    if (!listener) {
        error_set(error, ERROR_SERVER, "no memory for a listener");
        return NULL;
    }
    *listener = (struct listener){
        .loop = loop, .source = {-1, listener_ready, listener}, .fd = fd, .handler = *handler};
    return listener;
}

/* Starts to accept; if an earlier step failed, closes instead. */
static struct listener *start(struct listener *listener, bool ok, struct error *error)
{
    if (ok) {
        listener->source.fd = listener->fd;
        ok = loop_watch(listener->loop, &listener->source, EPOLLIN, error);
    }
    if (ok)
        return listener;
    listener_close(listener);
    return NULL;
}

struct listener *listener_open(struct loop *loop, const struct address *address,
                               enum listener_reach reach, const struct listener_handler *handler,
                               struct error *error)
{
    struct listener *listener = create(loop, -1, handler, error);
    if (!listener)
        return NULL;
    listener->address = *address;
    bool ok = address->kind == ADDRESS_UNIX ? open_unix(listener, error)
                                            : open_tcp(listener, reach, error);
    return start(listener, ok, error);
}

static bool adopt(struct listener *listener, bool tls, enum listener_reach reach,
                  struct error *error)
{
    union {
        struct sockaddr any;
        struct sockaddr_un local;
        struct sockaddr_storage room;
    } name = {.room = {0}};
    socklen_t size = sizeof name.room;
    int flags = fcntl(listener->fd, F_GETFL);
    if (flags < 0 || fcntl(listener->fd, F_SETFL, flags | O_NONBLOCK) < 0 ||
        getsockname(listener->fd, &name.any, &size) < 0)
        return error_set(error, ERROR_SERVER, "a socket from the service manager: %s",
                         strerror(errno));
    if (name.any.sa_family == AF_UNIX) {
        listener->address.kind = ADDRESS_UNIX;
        snprintf(listener->text, sizeof listener->text, "unix:%s",
                 name.local.sun_path[0] ? name.local.sun_path : "@");
        return true;
    }
    bool is_near = reach == LISTENER_ANYWHERE || is_loopback(&name.any);
    listener->address.kind = tls || !is_near ? ADDRESS_TLS : ADDRESS_TCP;
    describe_tcp(listener, &name.any, size);
    return true;
}

struct listener *listener_adopt(struct loop *loop, int fd, bool tls, enum listener_reach reach,
                                const struct listener_handler *handler, struct error *error)
{
    struct listener *listener = create(loop, fd, handler, error);
    if (listener)
        return start(listener, adopt(listener, tls, reach, error), error);
    close(fd);
    return NULL;
}

enum address_kind listener_kind(const struct listener *listener)
{
    return listener->address.kind;
}

/* True if the Unix socket's file is still the one made here. */
static bool has_file(const struct listener *listener)
{
    struct stat file;
    const struct stat *ours = &listener->file;
    return ours->st_ino != 0 && lstat(listener->address.path, &file) == 0 &&
           file.st_dev == ours->st_dev && file.st_ino == ours->st_ino;
}

void listener_open_to_all(const struct listener *listener, bool open)
{
    if (has_file(listener))
        chmod(listener->address.path, open ? 0666 : 0600);
}

void listener_close(struct listener *listener)
{
    if (!listener)
        return;
    loop_unwatch(listener->loop, &listener->source);
    if (has_file(listener))
        unlink(listener->address.path);
    if (listener->fd >= 0)
        close(listener->fd);
    free(listener);
}
