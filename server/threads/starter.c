#include "server/threads/starter.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <linux/close_range.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "server/sandbox/pass.h"
#include "server/sandbox/zygote.h"

enum { ANSWER_S = 10 }; /* longer than any request takes */

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

/* The first process of namespaces of its own: no network, no capability outside of them, no number of
 * another process. Where the kernel or the service manager refuses them, a process like others. */
static pid_t fork_apart(void)
{
    const long apart =
        CLONE_NEWUSER | CLONE_NEWNET | CLONE_NEWPID | CLONE_NEWNS | CLONE_NEWIPC | CLONE_NEWUTS;
    long pid = syscall(SYS_clone, apart | SIGCHLD, 0, 0, 0, 0);
    return pid >= 0 ? (pid_t)pid : fork();
}

/* Becomes the program, or tells errno through the pipe. */
static _Noreturn void become(const char *path, int socket_fd, int failed_fd)
{
    char program[PATH_MAX];
    char *const argv[] = {program, NULL};
    sigset_t none;
    snprintf(program, sizeof program, "%s", path);
    for (int number = 1; number < NSIG; number++)
        signal(number, SIG_DFL);
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, NULL);
    int null_fd = open("/dev/null", O_RDWR | O_CLOEXEC);
    if (null_fd >= 0 && dup2(null_fd, 0) == 0 && dup2(null_fd, 1) == 1 &&
        dup2(socket_fd, ZYGOTE_FD) == ZYGOTE_FD &&
        close_range(ZYGOTE_FD + 1, ~0u, CLOSE_RANGE_CLOEXEC) == 0)
        execv(program, argv);
    int failed = errno;
    _exit(write(failed_fd, &failed, sizeof failed) < 0);
}

/* A descriptor above ZYGOTE_FD in the place of fd, which is closed; -1 with errno. */
static int lift(int fd)
{
    int high_fd = fcntl(fd, F_DUPFD_CLOEXEC, ZYGOTE_FD + 1);
    close(fd);
    return high_fd;
}

static int start(const char *path, int socket_fd, pid_t *pid)
{
    int told[2], failed = 0;
    if (pipe2(told, O_CLOEXEC) < 0)
        return errno;
    told[1] = lift(told[1]);
    *pid = told[1] < 0 ? -1 : fork_apart();
    if (*pid == 0)
        become(path, socket_fd, told[1]);
    if (*pid < 0)
        failed = errno;
    if (told[1] >= 0)
        close(told[1]);
    if (!failed && read(told[0], &failed, sizeof failed) != sizeof failed)
        failed = 0; /* the program runs: the pipe closed */
    close(told[0]);
    if (failed && *pid > 0)
        wait_for(*pid);
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
        int socket_fd = n == 1 ? lift(fds[0]) : -1;
        failed = socket_fd >= 0 ? start(path, socket_fd, &pid) : 0;
        if (socket_fd >= 0)
            close(socket_fd);
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
    const struct timeval most = {.tv_sec = ANSWER_S};
    starter->fd = pair[0];
    setsockopt(starter->fd, SOL_SOCKET, SO_RCVTIMEO, &most, sizeof most);
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
    if (pass_send(starter->fd, &request, sizeof request, fds, n_fds) &&
        pass_receive(starter->fd, &failed, sizeof failed, none, &n_none) == sizeof failed)
        return failed;
    /* It is dead or stopped. A late answer must not be taken for that to another request. */
    shutdown(starter->fd, SHUT_RDWR);
    return ECHILD;
}

int starter_start(struct starter *starter, int socket_fd)
{
    return ask(starter, &socket_fd, 1);
}

void starter_stop(struct starter *starter)
{
    ask(starter, NULL, 0);
}

bool starter_is_alive(const struct starter *starter)
{
    struct pollfd end = {starter->fd, 0, 0};
    return poll(&end, 1, 0) == 0;
}

void starter_destroy(struct starter *starter)
{
    if (!starter)
        return;
    close(starter->fd);
    wait_for(starter->pid);
    free(starter);
}
