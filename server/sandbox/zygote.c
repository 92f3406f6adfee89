#include "server/sandbox/zygote.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "server/sandbox/landlock.h"
#include "server/sandbox/pass.h"
#include "server/sandbox/sandbox.h"
#include "server/sandbox/threads.h"

#define ANSWER_FD 3

struct child {
    pid_t pid;
    int end_fd;
    uint64_t deadline_ms;
    bool timed_out, stopped;
};

_Static_assert(N_JOB_FDS <= PASS_MAX_FDS, "a job's descriptors travel in one message");

struct zygote {
    const char *name;
    const struct zygote_task *tasks;
    int signal_fd;
    pid_t pid;
    uint64_t held_bytes;
    uint64_t next_beat_ms;
    size_t n_children;
    struct child children[ZYGOTE_MAX_CHILDREN];
};

static uint64_t now_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000 + (uint64_t)now.tv_nsec / 1000000;
}

/* --- the child */

/* Ends a child that cannot start its job; it has read nothing yet. */
static void fail_child(const struct zygote *zygote, const char *what, int code)
{
    fprintf(stderr, "%s: %s: %s\n", zygote->name, what, strerror(errno));
    _exit(code);
}

/* Closes all descriptors except the answer, which becomes ANSWER_FD, and standard error. */
static bool keep_answer(int answer_fd)
{
    return (answer_fd == ANSWER_FD || dup2(answer_fd, ANSWER_FD) == ANSWER_FD) &&
           close_range(0, 1, 0) == 0 && close_range(ANSWER_FD + 1, ~0u, 0) == 0;
}

static void enter_sandbox(const struct zygote *zygote, const struct job *job)
{
    if (!sandbox_limit(&job->limits, zygote->held_bytes) || !sandbox_enter(ANSWER_FD))
        fail_child(zygote, "the kernel refuses the sandbox of a job", ZYGOTE_EXIT_NO_SANDBOX);
}

static void run_child(const struct zygote *zygote, const struct job *job,
                      const int fds[static N_JOB_FDS])
{
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, NULL);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != zygote->pid)
        _exit(ZYGOTE_EXIT_NO_INPUT); /* the parent died before PR_SET_PDEATHSIG was set */
    void *bytes = mmap(NULL, job->input_bytes, PROT_READ, MAP_SHARED, fds[JOB_INPUT], 0);
    if (bytes == MAP_FAILED || !keep_answer(fds[JOB_ANSWER]))
        fail_child(zygote, "cannot take a job over", ZYGOTE_EXIT_NO_INPUT);
    enter_sandbox(zygote, job);
    struct source input = {bytes, job->input_bytes, true};
    struct sink answer;
    sink_init(&answer, ANSWER_FD);
    zygote->tasks[job->kind].run(&input, &answer);
    _exit(sink_flush(&answer) ? 0 : ZYGOTE_EXIT_NO_ANSWER);
}

/* --- the parent: ends of children */

static void tell(int end_fd, enum job_how how, uint32_t value)
{
    uint8_t message[JOB_END_BYTES];
    job_end_encode(&(struct job_end){how, value}, message);
    while (write(end_fd, message, sizeof message) < 0 && errno == EINTR)
        ;
}

/* Reports the end of a job to the daemon, and closes the pipe. */
static void report(int end_fd, enum job_how how, uint32_t value)
{
    tell(end_fd, how, value);
    close(end_fd);
}

static void reap(struct zygote *zygote)
{
    int status;
    for (pid_t pid; (pid = waitpid(-1, &status, WNOHANG | WUNTRACED)) > 0;) {
        struct child *child = zygote->children;
        while (child->pid != pid)
            child++;
        if (WIFSTOPPED(status)) {
            child->stopped = true;
            kill(pid, SIGKILL);
            continue;
        }
        if (child->stopped)
            report(child->end_fd, JOB_STOPPED, 0);
        else if (child->timed_out)
            report(child->end_fd, JOB_TIMED_OUT, 0);
        else if (WIFSIGNALED(status))
            report(child->end_fd, JOB_KILLED, (uint32_t)WTERMSIG(status));
        else
            report(child->end_fd, JOB_EXITED, (uint32_t)WEXITSTATUS(status));
        *child = zygote->children[--zygote->n_children];
    }
}

/* Tells the daemon, every JOB_BEAT_MS, that the program still serves its jobs. */
static void beat(struct zygote *zygote, uint64_t now)
{
    if (now < zygote->next_beat_ms)
        return;
    zygote->next_beat_ms = now + JOB_BEAT_MS;
    for (size_t i = 0; i < zygote->n_children; i++)
        tell(zygote->children[i].end_fd, JOB_RUNNING, 0);
}

/* Kills children that are overdue. Returns how long poll() may sleep, in ms; -1: for ever. */
static int kill_overdue(struct zygote *zygote)
{
    uint64_t now = now_ms(), next = zygote->n_children > 0 ? now + JOB_BEAT_MS : UINT64_MAX;
    beat(zygote, now);
    for (size_t i = 0; i < zygote->n_children; i++) {
        struct child *child = &zygote->children[i];
        if (child->timed_out)
            continue;
        if (child->deadline_ms <= now) {
            child->timed_out = true;
            kill(child->pid, SIGKILL);
        } else if (child->deadline_ms < next) {
            next = child->deadline_ms;
        }
    }
    return next == UINT64_MAX ? -1 : (int)(next - now);
}

/* --- the parent: jobs */

static void start_child(struct zygote *zygote, const struct job *job,
                        const int fds[static N_JOB_FDS])
{
    pid_t pid = zygote->tasks[job->kind].run ? fork() : -1;
    if (pid == 0)
        run_child(zygote, job, fds);
    if (pid < 0) {
        report(fds[JOB_END], JOB_NOT_RUN, zygote->tasks[job->kind].run ? (uint32_t)errno : ENOSYS);
    } else {
        const uint64_t deadline_ms = now_ms() + (uint64_t)job->limits.wall_s * 1000;
        zygote->children[zygote->n_children++] =
            (struct child){pid, fds[JOB_END], deadline_ms, false, false};
        tell(fds[JOB_END], JOB_RUNNING, 0);
    }
    close(fds[JOB_INPUT]);
    close(fds[JOB_ANSWER]);
}

/* Takes the next job. False at the end of the socket (errno is 0), or if the message is
 * malformed. */
static bool take_job(struct zygote *zygote)
{
    uint8_t message[JOB_MESSAGE_BYTES];
    int fds[PASS_MAX_FDS];
    size_t n_fds;
    struct job job;
    ssize_t size = pass_receive(ZYGOTE_FD, message, sizeof message, fds, &n_fds);
    if (size == 0)
        errno = 0;
    if (size <= 0)
        return false;
    if (n_fds == N_JOB_FDS && job_decode(&job, message, (size_t)size)) {
        start_child(zygote, &job, fds);
        return true;
    }
    while (n_fds > 0)
        close(fds[--n_fds]);
    errno = EBADMSG;
    return false;
}

static bool serve(struct zygote *zygote)
{
    for (;;) {
        struct pollfd polls[] = {{zygote->signal_fd, POLLIN, 0}, {ZYGOTE_FD, POLLIN, 0}};
        const nfds_t n = zygote->n_children < ZYGOTE_MAX_CHILDREN ? 2 : 1;
        if (poll(polls, n, kill_overdue(zygote)) < 0 && errno != EINTR)
            return false;
        struct signalfd_siginfo signal;
        if (polls[0].revents && read(zygote->signal_fd, &signal, sizeof signal) > 0)
            reap(zygote);
        if (polls[1].revents && !take_job(zygote))
            return errno == 0;
    }
}

/* Overwrites the environment, which may hold secrets of whoever started the daemon: it lies where every
 * job's process could read it. */
static void forget_environment(void)
{
    for (char **entry = environ; entry && *entry; entry++)
        explicit_bzero(*entry, strlen(*entry));
    clearenv();
}

int zygote_main(int argc, char **argv, const struct zygote_task tasks[static N_JOB_KINDS])
{
    static struct zygote zygote;
    struct stat file;
    const char *slash = argc > 0 ? strrchr(argv[0], '/') : NULL;
    const char *name = slash ? slash + 1 : argc > 0 ? argv[0] : "worker";
    if (argc > 1 || fstat(ZYGOTE_FD, &file) < 0 || !S_ISSOCK(file.st_mode)) {
        fprintf(stderr, "%s is a part of sheend, which starts it; it does nothing by itself\n",
                name);
        return 2;
    }
    forget_environment();
    sigset_t set;
    zygote = (struct zygote){.name = name, .tasks = tasks, .pid = getpid()};
    sigemptyset(&set);
    sigaddset(&set, SIGCHLD);
    sigprocmask(SIG_BLOCK, &set, NULL);
    signal(SIGPIPE, SIG_IGN); /* the daemon may have closed the pipe for a job's end */
    zygote.signal_fd = signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK);
    bool ok =
        zygote.signal_fd >= 0 && threads_wait_idle() && sandbox_held_bytes(&zygote.held_bytes);
    landlock_enter(); /* the program has read what it needs; where there is no Landlock, go on */
    ok = ok && serve(&zygote);
    if (!ok)
        fprintf(stderr, "%s: cannot go on: %s\n", name, strerror(errno));
    fflush(stderr);
    _exit(ok ? 0 : 1); /* _exit(): the libraries were only loaded and have nothing to clean up */
}
