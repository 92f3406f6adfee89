#include "server/ops/notify.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#define FIRST_FD 3 /* SD_LISTEN_FDS_START */

/* The service manager's socket; -1: there is none. */
static int manager_fd = -1;

void notify_open(void)
{
    const char *path = getenv("NOTIFY_SOCKET");
    struct sockaddr_un name = {.sun_family = AF_UNIX};
    if (!path || (path[0] != '/' && path[0] != '@') || strlen(path) >= sizeof name.sun_path)
        return;
    size_t length = strlen(path);
    memcpy(name.sun_path, path, length);
    if (path[0] == '@')
        name.sun_path[0] = 0; /* an abstract socket name (Linux) */
    int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (fd < 0)
        return;
    socklen_t size = (socklen_t)(offsetof(struct sockaddr_un, sun_path) + length);
    if (connect(fd, (const struct sockaddr *)&name, size) == 0)
        manager_fd = fd;
    else
        close(fd);
}

void notify_send(const char *state)
{
    if (manager_fd >= 0)
        send(manager_fd, state, strlen(state), MSG_NOSIGNAL | MSG_DONTWAIT);
}

/* Reads an environment variable that holds a decimal number and nothing else. False if there is no
 * such variable, or if it holds something else. */
static bool read_variable(const char *name, uint64_t *value)
{
    const char *text = getenv(name);
    char *end;
    if (!text || *text < '0' || *text > '9')
        return false;
    errno = 0;
    *value = strtoull(text, &end, 10);
    return errno == 0 && *end == 0;
}

uint64_t notify_watchdog_us(void)
{
    uint64_t us, pid;
    if (!read_variable("WATCHDOG_USEC", &us))
        return 0;
    bool other = getenv("WATCHDOG_PID") &&
                 !(read_variable("WATCHDOG_PID", &pid) && pid == (uint64_t)getpid());
    return other ? 0 : us;
}

/* LISTEN_FDNAMES: a name for each descriptor, separated by ':'. */
static void take_names(struct notify_fds *fds)
{
    const char *names = getenv("LISTEN_FDNAMES");
    for (size_t i = 0; names && *names && i < fds->n; i++) {
        size_t length = strcspn(names, ":");
        snprintf(fds->name[i], sizeof fds->name[i], "%.*s", (int)length, names);
        names += length + (names[length] == ':');
    }
}

bool notify_listen_fds(struct notify_fds *fds, struct error *error)
{
    uint64_t pid, n;
    *fds = (struct notify_fds){.n = 0};
    /* The variables may be meant for a parent process: a child inherits them, but not the
     * sockets. */
    if (!read_variable("LISTEN_PID", &pid) || pid != (uint64_t)getpid())
        return true;
    if (!read_variable("LISTEN_FDS", &n) || n > NOTIFY_MAX_FDS)
        return error_set(error, ERROR_SERVER,
                         "LISTEN_FDS is '%s'; a service manager passes 0 to %d sockets",
                         getenv("LISTEN_FDS") ? getenv("LISTEN_FDS") : "", NOTIFY_MAX_FDS);
    fds->n = (size_t)n;
    take_names(fds);
    for (size_t i = 0; i < fds->n; i++) {
        int fd = FIRST_FD + (int)i, listens = 0;
        socklen_t size = sizeof listens;
        if (getsockopt(fd, SOL_SOCKET, SO_ACCEPTCONN, &listens, &size) < 0 || !listens)
            return error_set(error, ERROR_SERVER,
                             "descriptor %d from the service manager is no listening stream socket",
                             fd);
        fcntl(fd, F_SETFD, FD_CLOEXEC);
        fds->fd[i] = fd;
    }
    unsetenv("LISTEN_PID");
    unsetenv("LISTEN_FDS");
    unsetenv("LISTEN_FDNAMES");
    return true;
}
