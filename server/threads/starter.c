#include "server/threads/starter.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "protocol/child.h"
#include "server/sandbox/pass.h"
#include "server/sandbox/zygote.h"

struct starter {
    int fd;
    pid_t pid;
};

/* A request has no content: with a descriptor it starts the program, without one it stops it. The
 * answer is an errno value. */

static void wait_for(pid_t pid)
{
    while (waitpid(pid, NULL, 0) < 0 && errno == EINTR)
        ;
}

/* --- the process */

static void stop(pid_t *pid)
{
    if (*pid <= 0)
        return;
    kill(*pid, SIGKILL); /* its children die with it */
    wait_for(*pid);
    *pid = 0;
}

static int start(const char *path, int socket_fd, pid_t *pid)
{
    int high_fd = fcntl(socket_fd, F_DUPFD_CLOEXEC, ZYGOTE_FD + 1);
    if (high_fd < 0)
        return errno;
    const char *const argv[] = {path, NULL};
    const struct child_files files = {high_fd, ZYGOTE_FD, -1};
    int failed = child_start(pid, path, argv, &files);
    close(high_fd);
    if (failed)
        *pid = 0;
    return failed;
}

/* Serves until the daemon closes the socket. */
static void serve(int fd, const char *path)
{
    pid_t pid = 0;
    char request = 0;
    int fds[PASS_MAX_FDS], failed = 0;
    size_t n;
    do {
        if (pass_receive(fd, &request, sizeof request, fds, &n) <= 0)
            break;
        stop(&pid);
        failed = n == 1 ? start(path, fds[0], &pid) : 0;
        while (n > 0)
            close(fds[--n]);
    } while (pass_send(fd, &failed, sizeof failed, NULL, 0));
    stop(&pid);
}

/* Keeps nothing of the daemon's but its end of the socket and standard error. Signals that the
 * daemon blocks stay blocked: told to end, the daemon may still need the program for a while. */
static _Noreturn void run(int fd, const char *path)
{
    prctl(PR_SET_NAME, "sheend-starter");
    if (fd > STDERR_FILENO + 1)
        close_range(STDERR_FILENO + 1, (unsigned)fd - 1, 0);
    close_range((unsigned)fd + 1, ~0u, 0);
    serve(fd, path);
    _exit(0);
}

/* --- the daemon's side */

struct starter *starter_create(const char *path, struct error *error)
{
    int pair[2];
    struct starter *starter = calloc(1, sizeof *starter);
    if (!starter || socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair) < 0) {
        error_set(error, ERROR_SERVER, "cannot start %s: %s", path, strerror(errno));
        free(starter);
        return NULL;
    }
    starter->fd = pair[0];
    starter->pid = fork();
    if (starter->pid == 0)
        run(pair[1], path);
    int failed = errno;
    close(pair[1]);
    if (starter->pid > 0)
        return starter;
    close(starter->fd);
    free(starter);
    error_set(error, ERROR_SERVER, "cannot start %s: %s", path, strerror(failed));
    return NULL;
}

static int ask(struct starter *starter, const int fds[], size_t n_fds)
{
    const char request = 0;
    int failed = 0, none[PASS_MAX_FDS];
    size_t n_none;
    if (!pass_send(starter->fd, &request, sizeof request, fds, n_fds) ||
        pass_receive(starter->fd, &failed, sizeof failed, none, &n_none) != sizeof failed)
        return ECHILD;
    return failed;
}

int starter_start(struct starter *starter, int socket_fd)
{
    return ask(starter, &socket_fd, 1);
}

void starter_stop(struct starter *starter)
{
    ask(starter, NULL, 0);
}

void starter_destroy(struct starter *starter)
{
    if (!starter)
        return;
    close(starter->fd);
    wait_for(starter->pid);
    free(starter);
}
