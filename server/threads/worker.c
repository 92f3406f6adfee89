#include "server/threads/worker.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/sandbox/pass.h"
#include "server/sandbox/zygote.h"
#include "server/threads/pool.h"
#include "server/threads/starter.h"

#define ATTEMPTS 2
#define GRACE_S 10 /* added to a job's time: for the program to report its end */
/* Period of pool_beat(): shorter than the time after which a thread counts as stuck. */
#define BEAT_MS 500

struct worker {
    char path[WORKER_PATH_BYTES];
    pthread_mutex_t lock;
    int socket_fd; /* -1: not running */
    struct starter *starter;
    unsigned starts; /* number of starts, to know which process got a job */
    bool stopped;
    unsigned n_silent; /* jobs that have not heard of the program for WORKER_SILENT_MS */
    size_t n_spares;
    int spare_fds[WORKER_MAX_SPARES]; /* input files of ended jobs */
};

static const char *program_name(const struct worker *worker)
{
    const char *slash = strrchr(worker->path, '/');
    return slash ? slash + 1 : worker->path;
}

/* --- the program; call with worker->lock held, or before other threads know the worker */

static bool start(struct worker *worker, struct error *error)
{
    int pair[2], failed = 0;
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair) < 0)
        failed = errno;
    if (!failed) {
        failed = starter_start(worker->starter, pair[1]);
        close(pair[1]);
        if (failed)
            close(pair[0]);
    }
    if (failed)
        return error_set(error, ERROR_SERVER, "cannot start %s: %s", worker->path,
                         strerror(failed));
    worker->socket_fd = pair[0];
    worker->starts++;
    return true;
}

static void end(struct worker *worker)
{
    if (worker->socket_fd < 0)
        return;
    close(worker->socket_fd);
    worker->socket_fd = -1;
    starter_stop(worker->starter);
}

struct worker *worker_create(const char *path, struct error *error)
{
    struct worker *worker = calloc(1, sizeof *worker);
    if (!worker) {
        error_set(error, ERROR_SERVER, "no memory for a worker");
        return NULL;
    }
    worker->starter = starter_create(path, error);
    if (!worker->starter) {
        free(worker);
        return NULL;
    }
    snprintf(worker->path, sizeof worker->path, "%s", path);
    pthread_mutex_init(&worker->lock, NULL);
    worker->socket_fd = -1;
    return worker;
}

bool worker_wake(struct worker *worker, struct error *error)
{
    pthread_mutex_lock(&worker->lock);
    bool ok = worker->stopped || worker->socket_fd >= 0 || start(worker, error);
    pthread_mutex_unlock(&worker->lock);
    return ok;
}

enum worker_health worker_health(struct worker *worker)
{
    pthread_mutex_lock(&worker->lock);
    bool is_silent = worker->n_silent > 0;
    bool is_lost = !worker->stopped && !starter_is_alive(worker->starter);
    pthread_mutex_unlock(&worker->lock);
    return is_lost ? WORKER_LOST : is_silent ? WORKER_SILENT : WORKER_WELL;
}

void worker_stop(struct worker *worker)
{
    pthread_mutex_lock(&worker->lock);
    worker->stopped = true;
    end(worker);
    pthread_mutex_unlock(&worker->lock);
}

void worker_destroy(struct worker *worker)
{
    if (!worker)
        return;
    end(worker);
    starter_destroy(worker->starter);
    while (worker->n_spares > 0)
        close(worker->spare_fds[--worker->n_spares]);
    pthread_mutex_destroy(&worker->lock);
    free(worker);
}

/* --- files in memory */

static int take_spare(struct worker *worker)
{
    int fd = -1;
    pthread_mutex_lock(&worker->lock);
    if (worker->n_spares > 0)
        fd = worker->spare_fds[--worker->n_spares];
    pthread_mutex_unlock(&worker->lock);
    return fd >= 0 && lseek(fd, 0, SEEK_SET) == 0 ? fd : -1;
}

/* Keeps an input file for the next job. The process that read it is dead. */
static void keep_spare(struct worker *worker, int fd)
{
    bool fits = lseek(fd, 0, SEEK_CUR) <= (off_t)WORKER_MAX_SPARE_BYTES;
    pthread_mutex_lock(&worker->lock);
    fits = fits && worker->n_spares < WORKER_MAX_SPARES;
    if (fits)
        worker->spare_fds[worker->n_spares++] = fd;
    pthread_mutex_unlock(&worker->lock);
    if (!fits)
        close(fd);
}

bool worker_call_init_lent(struct worker_call *call, struct worker *lender, struct error *error)
{
    *call = (struct worker_call){.lender = lender, .mapping = MAP_FAILED};
    call->input_fd = lender ? take_spare(lender) : -1;
    if (call->input_fd < 0)
        call->input_fd = memfd_create("sheend-input", MFD_CLOEXEC);
    call->answer_fd = -1;
    sink_init(&call->input, call->input_fd);
    return call->input_fd >= 0 ||
           error_set(error, ERROR_SERVER, "cannot make a file in memory: %s", strerror(errno));
}

bool worker_call_init(struct worker_call *call, struct error *error)
{
    return worker_call_init_lent(call, NULL, error);
}

void worker_call_finish(struct worker_call *call)
{
    if (call->input_fd >= 0 && call->lender && call->ended)
        keep_spare(call->lender, call->input_fd);
    else if (call->input_fd >= 0)
        close(call->input_fd);
    if (call->answer_fd >= 0)
        close(call->answer_fd);
    if (call->mapping != MAP_FAILED)
        munmap(call->mapping, call->mapping_bytes);
}

/* Maps the answer. The job's process is dead. The file is sealed, so that nobody who may still hold
 * it can change it; sealing fails if it is mapped for writing. */
static bool open_answer(struct worker_call *call)
{
    const int seals = F_SEAL_SEAL | F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE;
    struct stat file;
    if (fcntl(call->answer_fd, F_ADD_SEALS, seals) < 0 || fstat(call->answer_fd, &file) < 0 ||
        file.st_size <= 0)
        return false;
    call->mapping_bytes = (size_t)file.st_size;
    call->mapping = mmap(NULL, call->mapping_bytes, PROT_READ, MAP_SHARED, call->answer_fd, 0);
    call->answer = (struct source){call->mapping, call->mapping_bytes, true};
    return call->mapping != MAP_FAILED;
}

/* --- one job */

/* Sends the job to the program, which is started if needed. False if it cannot take the job.
 * *starts tells which process has it. */
static bool submit(struct worker *worker, const struct job *job, const int fds[static N_JOB_FDS],
                   unsigned *starts, struct error *error)
{
    uint8_t message[JOB_MESSAGE_BYTES];
    job_encode(job, message);

    pthread_mutex_lock(&worker->lock);
    bool ok = worker->stopped ? error_set(error, ERROR_SERVER, "the daemon is shutting down")
                              : worker->socket_fd >= 0 || start(worker, error);
    if (ok && !pass_send(worker->socket_fd, message, sizeof message, fds, N_JOB_FDS))
        ok = error_set(error, ERROR_SERVER, "%s takes no job: %s", program_name(worker),
                       strerror(errno));
    *starts = worker->starts;
    pthread_mutex_unlock(&worker->lock);
    return ok;
}

/* Cleans up after a program that died or hangs, once for each start. */
static void bury(struct worker *worker, unsigned starts)
{
    pthread_mutex_lock(&worker->lock);
    if (worker->starts == starts && worker->socket_fd >= 0) {
        end(worker);
        log_event(LOG_WARN,
                  "a reader had died or was stopped; it is started again when it is needed",
                  log_text("program", program_name(worker)));
    }
    pthread_mutex_unlock(&worker->lock);
}

/* Notes that one job more, or one less, hears nothing of the program. */
static void set_silent(struct worker *worker, bool *is_silent, bool now)
{
    if (*is_silent == now)
        return;
    *is_silent = now;
    pthread_mutex_lock(&worker->lock);
    worker->n_silent += now ? 1 : -1u;
    pthread_mutex_unlock(&worker->lock);
}

/* Waits for the next message about a job. False if there is none within BEAT_MS; *is_over: there will
 * be none, or it is malformed. */
static bool hear(int end_fd, struct job_end *job_end, bool *is_over)
{
    struct pollfd end = {end_fd, POLLIN, 0};
    uint8_t message[JOB_END_BYTES];
    pool_beat();
    int n = poll(&end, 1, BEAT_MS);
    *is_over = n < 0 && errno != EINTR;
    if (n <= 0)
        return false;
    ssize_t size = read(end_fd, message, sizeof message);
    *is_over = size <= 0 || !job_end_decode(job_end, message, (size_t)size);
    return !*is_over;
}

/* Waits for the end of a job. False if the program died, is stopped or did not report in time. */
static bool await(struct worker *worker, int end_fd, const struct job *job, struct job_end *job_end)
{
    uint64_t heard_us = clock_now_us();
    const uint64_t deadline_us = heard_us + ((uint64_t)job->limits.wall_s + GRACE_S) * 1000000;
    bool is_over = false, is_silent = false, has_ended = false;
    while (!is_over && !has_ended) {
        bool heard = hear(end_fd, job_end, &is_over);
        uint64_t now_us = clock_now_us();
        has_ended = heard && job_end->how != JOB_RUNNING;
        if (heard)
            heard_us = now_us;
        set_silent(worker, &is_silent, now_us - heard_us > WORKER_SILENT_MS * 1000);
        is_over = is_over || now_us > deadline_us || now_us - heard_us > WORKER_DEAD_MS * 1000;
    }
    set_silent(worker, &is_silent, false);
    return has_ended;
}

/* Makes a new file for the answer of each attempt: a process of an earlier attempt may still write
 * to the old one. */
static bool renew_answer(struct worker_call *call, struct error *error)
{
    if (call->answer_fd >= 0)
        close(call->answer_fd);
    call->answer_fd = memfd_create("sheend-answer", MFD_CLOEXEC | MFD_ALLOW_SEALING);
    return call->answer_fd >= 0 ||
           error_set(error, ERROR_SERVER, "cannot make a file in memory: %s", strerror(errno));
}

/* The job's process gets the input by a descriptor that can only be read: its mapping can be neither
 * written nor made writable. -1 with *error. */
static int read_only(int fd, struct error *error)
{
    char path[32];
    snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
    int only = open(path, O_RDONLY | O_CLOEXEC);
    if (only < 0)
        error_set(error, ERROR_SERVER, "cannot open a file in memory: %s", strerror(errno));
    return only;
}

/* Sends the job and waits for it, one time. */
static bool attempt(struct worker *worker, const struct worker_call *call, const struct job *job,
                    struct job_end *job_end, struct error *error)
{
    int ends[2];
    unsigned starts;
    const int input_fd = read_only(call->input_fd, error);
    if (input_fd < 0)
        return false;
    if (pipe2(ends, O_CLOEXEC) < 0) {
        close(input_fd);
        return error_set(error, ERROR_SERVER, "cannot make a pipe: %s", strerror(errno));
    }
    const int fds[N_JOB_FDS] = {input_fd, call->answer_fd, ends[1]};
    bool ok = submit(worker, job, fds, &starts, error);
    close(input_fd);
    close(ends[1]); /* only the program keeps this end: if it dies, the pipe closes */
    if (ok && !await(worker, ends[0], job, job_end))
        ok = error_set(error, ERROR_SERVER, "%s has died or was stopped: try again",
                       program_name(worker));
    close(ends[0]);
    if (!ok)
        bury(worker, starts);
    return ok;
}

/* Describes in *error why a job gave no answer. */
static bool explain(const struct job_end *end, const struct job_limits *limits, const char *name,
                    enum error_kind damage, struct error *error)
{
    if (end->how == JOB_TIMED_OUT)
        return error_set(error, ERROR_SERVER, "%s: not done in %u s: try again later", name,
                         limits->wall_s);
    if (end->how == JOB_STOPPED)
        return error_set(error, ERROR_SERVER, "%s: its process was stopped: try again later", name);
    if (end->how == JOB_NOT_RUN)
        return error_set(error, ERROR_SERVER, "%s: no process for it: %s: try again later", name,
                         strerror((int)end->value));
    if (end->how == JOB_EXITED && end->value == ZYGOTE_EXIT_NO_SANDBOX)
        return error_set(error, ERROR_SERVER,
                         "%s: it is not touched, since the kernel refuses the sandbox (seccomp): "
                         "see the daemon's log",
                         name);
    if (end->how == JOB_EXITED)
        return error_set(error, damage, "%s: its process gave no answer (exit code %u)", name,
                         end->value);
    switch (end->value) {
    case SIGSYS:
        return error_set(error, damage,
                         "%s: its process tried what its sandbox forbids and was ended: the file "
                         "is damaged or hostile",
                         name);
    case SIGXCPU:
        return error_set(error, damage, "%s: more than %u s of processor time: it is not taken",
                         name, limits->cpu_s);
    case SIGXFSZ:
        return error_set(error, damage, "%s: more than %llu MB come out of it: it is not taken",
                         name, (unsigned long long)limits->answer_bytes >> 20);
    case SIGKILL:
    case SIGTERM:
        return error_set(error, ERROR_SERVER, "%s: its process was killed: try again later", name);
    default:
        return error_set(error, damage,
                         "%s: its process crashed (signal %u): the file is damaged or hostile",
                         name, end->value);
    }
}

/* Reads the status of an answer. If a worker lacked memory, its limit was the reason. */
static bool read_status(struct worker_call *call, const struct job_limits *limits, const char *name,
                        enum error_kind damage, struct error *error)
{
    struct error found = {0};
    switch (answer_read_status(&call->answer, &found)) {
    case ANSWER_OK:
        return true;
    case ANSWER_FAILED:
        if (found.kind == ERROR_SERVER)
            return error_set(error, damage, "%s (of the %llu MB that it may take)", found.text,
                             (unsigned long long)limits->memory_bytes >> 20);
        return error_set(error, found.kind, "%s", found.text);
    default:
        return error_set(error, damage, "%s: its process gave a broken answer", name);
    }
}

bool worker_run(struct worker *worker, struct worker_call *call, enum job_kind kind,
                const struct job_limits *limits, const char *name, enum error_kind damage,
                struct error *error)
{
    const off_t input_bytes = sink_flush(&call->input) ? lseek(call->input_fd, 0, SEEK_CUR) : -1;
    /* A file of before may be longer: nothing of that job is left in it. */
    if (input_bytes <= 0 || ftruncate(call->input_fd, input_bytes) < 0)
        return error_set(error, ERROR_SERVER, "%s: no memory to hand it on: try again later", name);
    const struct job job = {kind, *limits, (uint64_t)input_bytes};
    struct job_end job_end = {0};
    int attempts = 0;
    while (!call->ended || (job_end.how == JOB_STOPPED && attempts < ATTEMPTS)) {
        if (attempts++ == ATTEMPTS)
            break;
        call->ended = renew_answer(call, error) && attempt(worker, call, &job, &job_end, error);
    }
    if (!call->ended)
        return false;
    if (job_end.how != JOB_EXITED || job_end.value != 0)
        return explain(&job_end, limits, name, damage, error);
    if (!open_answer(call))
        return error_set(error, damage, "%s: its process gave no answer", name);
    return read_status(call, limits, name, damage, error);
}
