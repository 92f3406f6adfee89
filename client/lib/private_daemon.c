#include "client/lib/private_daemon.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "client/lib/machine_memory.h"
#include "client/lib/status.h"
#include "protocol/child.h"
#include "protocol/limits.h"

#define SESSION_FD 3 /* the first one after standard error; higher ones are closed in the daemon */
#define END_MS 10000 /* time for the daemon to finish after its socket is closed */
#define TERM_MS 2000

#define PATH_BYTES 4096

/* Writes the daemon's path, or just its name, which is then searched on the PATH. */
static void find_daemon(char path[static PATH_BYTES])
{
    const char *chosen = getenv("SHEEN_DAEMON");
    if (chosen && *chosen && strlen(chosen) < PATH_BYTES) {
        snprintf(path, PATH_BYTES, "%s", chosen);
        return;
    }
    static const char name[] = "sheend";
    ssize_t n = readlink("/proc/self/exe", path, PATH_BYTES - sizeof(name));
    if (n > 0) {
        path[n] = 0;
        char *slash = strrchr(path, '/');
        if (slash) {
            memcpy(slash + 1, name, sizeof(name));
            if (access(path, X_OK) == 0)
                return;
        }
    }
    memcpy(path, name, sizeof(name));
}

/* The memory budget of the daemon; `asked` 0: half of the machine's memory. */
static uint64_t budget_bytes(uint64_t asked)
{
    uint64_t half = machine_memory_bytes("") / 2;
    if (asked > 0 || half == 0)
        return asked;
    return half > PROTOCOL_LEAST_MEMORY_BYTES ? half : PROTOCOL_LEAST_MEMORY_BYTES;
}

static int spawn(pid_t *pid, const char *path, int session_fd, int stderr_fd,
                 const struct sheen_connect_options *options)
{
    uint64_t bytes = budget_bytes(options->memory_budget_bytes);
    char fd_text[12], threads_text[12], bytes_text[24];
    snprintf(fd_text, sizeof(fd_text), "%d", SESSION_FD);
    snprintf(threads_text, sizeof(threads_text), "%u", options->native_threads);
    snprintf(bytes_text, sizeof(bytes_text), "%" PRIu64, bytes);
    const char *argv[14] = {"sheend", "--session-fd", fd_text};
    const char *const more[][2] = {
        {"--device", options->device},
        {"--native-threads", options->native_threads ? threads_text : NULL},
        {"--native-isa", options->native_isa},
        {"--memory-budget", bytes ? bytes_text : NULL},
        {"--peer-memory", bytes ? bytes_text : NULL}};
    for (size_t i = 0, n = 3; i < sizeof(more) / sizeof(*more); i++)
        if (more[i][1]) {
            argv[n++] = more[i][0];
            argv[n++] = more[i][1];
        }
    const struct child_files files = {session_fd, SESSION_FD, stderr_fd};
    return child_start(pid, path, argv, &files);
}

enum sheen_status private_daemon_start(struct private_daemon *daemon, int session_fd,
                                       const struct sheen_connect_options *options,
                                       struct sheen_error *error)
{
    char path[PATH_BYTES];
    int failed = 0;
    *daemon = (struct private_daemon){.stderr_fd = -1};
    find_daemon(path);
    int high_fd = fcntl(session_fd, F_DUPFD_CLOEXEC, SESSION_FD + 1);
    int memory_fd = memfd_create("sheend-stderr", MFD_CLOEXEC);
    daemon->stderr_fd = memory_fd < 0 ? -1 : fcntl(memory_fd, F_DUPFD_CLOEXEC, SESSION_FD + 1);
    if (high_fd < 0 || daemon->stderr_fd < 0)
        failed = errno;
    else
        failed = spawn(&daemon->pid, path, high_fd, daemon->stderr_fd, options);
    if (high_fd >= 0)
        close(high_fd);
    if (memory_fd >= 0)
        close(memory_fd);
    if (!failed)
        return SHEEN_OK;
    daemon->pid = 0;
    private_daemon_finish(daemon);
    return status_set(error, SHEEN_NO_SERVER,
                      "cannot start a private daemon (%.300s): %s; install sheend, set "
                      "SHEEN_DAEMON to its path, or name a running one with --server",
                      path, strerror(failed));
}

/* Reaps the daemon if it ends within wait_ms. */
static bool reap(struct private_daemon *daemon, int wait_ms, int *how)
{
    const struct timespec nap = {.tv_nsec = 2000000};
    for (int waited_ms = 0;; waited_ms += 2) {
        pid_t ended = waitpid(daemon->pid, how, WNOHANG);
        if (ended == daemon->pid || (ended < 0 && errno == ECHILD)) {
            if (ended < 0)
                *how = 0; /* the program ignores SIGCHLD, so the system has reaped it */
            daemon->pid = 0;
            return true;
        }
        if (waited_ms >= wait_ms)
            return false;
        nanosleep(&nap, NULL);
    }
}

/* Reads the last line that is not empty, without its newline; "" if there is none. */
static void last_line(const struct private_daemon *daemon, char *line, size_t line_bytes)
{
    line[0] = 0;
    char tail[2048];
    off_t end = lseek(daemon->stderr_fd, 0, SEEK_END);
    if (end <= 0)
        return;
    off_t start = end > (off_t)sizeof(tail) ? end - (off_t)sizeof(tail) : 0;
    ssize_t n = pread(daemon->stderr_fd, tail, sizeof(tail), start);
    while (n > 0 && (tail[n - 1] == '\n' || tail[n - 1] == ' '))
        n--;
    if (n <= 0)
        return;
    ssize_t first = n;
    while (first > 0 && tail[first - 1] != '\n')
        first--;
    static const char prefix[] = "sheend: "; /* the caller prefixes `sheen: ` */
    if (n - first >= (ssize_t)sizeof(prefix) && strncmp(tail + first, prefix, strlen(prefix)) == 0)
        first += (ssize_t)strlen(prefix);
    snprintf(line, line_bytes, "%.*s", (int)(n - first), tail + first);
}

enum sheen_status private_daemon_explain(struct private_daemon *daemon, enum sheen_status status,
                                         struct sheen_error *error)
{
    int how = 0;
    if (daemon->pid == 0 || !reap(daemon, TERM_MS, &how))
        return status;
    char line[480], end[64];
    last_line(daemon, line, sizeof(line));
    if (WIFSIGNALED(how))
        snprintf(end, sizeof(end), "the private daemon died of signal %d", WTERMSIG(how));
    else
        snprintf(end, sizeof(end), "the private daemon ended with exit code %d", WEXITSTATUS(how));
    if (WIFEXITED(how) && WEXITSTATUS(how) == 5)
        status = SHEEN_DEVICE_FAILED;
    if (line[0] && WIFEXITED(how) && WEXITSTATUS(how) != 0)
        return status_set(error, status, "%s", line);
    return status_set(error, status, "%s%s%s", end, line[0] ? ": " : "", line);
}

void private_daemon_finish(struct private_daemon *daemon)
{
    int how;
    if (daemon->pid > 0 && !reap(daemon, END_MS, &how)) {
        kill(daemon->pid, SIGTERM);
        if (!reap(daemon, TERM_MS, &how)) {
            kill(daemon->pid, SIGKILL);
            while (waitpid(daemon->pid, &how, 0) < 0 && errno == EINTR)
                ;
        }
    }
    daemon->pid = 0;
    if (daemon->stderr_fd >= 0)
        close(daemon->stderr_fd);
    daemon->stderr_fd = -1;
}
