/* Worker processes for files from strangers: a parser that was taken over can do nothing, its end
 * is reported, and nothing of it remains. The programs are tests/worker/bad_worker.c and the real
 * workers. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <dirent.h>
#include <errno.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <time.h>

#include "server/threads/workers.h"
#include "server/sandbox/landlock.h"
#include "server/sandbox/threads.h"
#include "tests/unit/build_folder.h"

#ifdef __SANITIZE_ADDRESS__
enum { SANITIZED = true }; /* a sanitizer takes more memory than any limit allows */
#else
enum { SANITIZED = false };
#endif

static const struct job_limits JOB_LIMITS = {64 << 20, 1 << 20, 1, 20};

static struct worker *worker;

static int start_worker(void **state)
{
    char path[PATH_MAX + 32];
    struct error error = {0};
    (void)state;
    snprintf(path, sizeof path, "%s/tests/bad_worker", build_folder());
    worker = worker_create(path, &error);
    if (!worker)
        fail_msg("%s", error.text);
    return 0;
}

static int end_worker(void **state)
{
    (void)state;
    worker_destroy(worker);
    return 0;
}

/* --- processes and descriptors */

static void nap(void)
{
    nanosleep(&(struct timespec){.tv_nsec = 2000000}, NULL);
}

/* The first child of a process, for which it waits up to two seconds; 0 if there is none. */
static pid_t child_of(pid_t parent)
{
    char path[64];
    snprintf(path, sizeof path, "/proc/%d/task/%d/children", parent, parent);
    int child = 0;
    for (int i = 0; i < 1000 && child == 0; i++) {
        FILE *file = fopen(path, "r");
        if (!file || fscanf(file, "%d", &child) != 1)
            nap();
        if (file)
            fclose(file);
    }
    return child;
}

/* The process of the worker program: a child of its starter. */
static pid_t worker_program(void)
{
    return child_of(child_of(getpid()));
}

/* Whether the process has ended, or is a zombie that its new parent has not reaped yet. */
static bool is_dead(pid_t pid)
{
    char path[64], state = 'Z';
    snprintf(path, sizeof path, "/proc/%d/stat", pid);
    FILE *file = fopen(path, "r");
    if (!file)
        return true;
    if (fscanf(file, "%*d (%*[^)]) %c", &state) != 1)
        state = 'Z';
    fclose(file);
    return state == 'Z' || state == 'X';
}

static void assert_dies(pid_t pid)
{
    for (int i = 0; i < 1000 && !is_dead(pid); i++)
        nap();
    assert_true(is_dead(pid));
}

static int count_entries(const char *folder)
{
    int n = 0;
    DIR *entries = opendir(folder);
    assert_non_null(entries);
    for (const struct dirent *entry; (entry = readdir(entries));)
        n += entry->d_name[0] != '.';
    closedir(entries);
    return n;
}

/* --- jobs */

static bool run_job(const char *name, const struct job_limits *limits, struct error *error)
{
    struct worker_call call;
    bool ok = worker_call_init(&call, error);
    job_write_file(&call.input, name, "bytes", 5);
    ok = ok && worker_run(worker, &call, JOB_READ_CAGE, limits, name, ERROR_MODEL, error);
    if (ok && strcmp(name, "echo") == 0) {
        assert_int_equal(call.answer.left, 5);
        assert_memory_equal(call.answer.at, "bytes", 5);
    }
    worker_call_finish(&call);
    return ok;
}

static void assert_works(void)
{
    struct error error = {0};
    if (!run_job("echo", &JOB_LIMITS, &error))
        fail_msg("%s", error.text);
}

static void assert_fails(const char *name, enum error_kind kind, const char *words)
{
    struct error error = {0};
    if (run_job(name, &JOB_LIMITS, &error))
        fail_msg("%s passed", name);
    if (error.kind != kind || !strstr(error.text, words) ||
        strncmp(error.text, name, strlen(name)) != 0)
        fail_msg("%s: %d: %s", name, error.kind, error.text);
    assert_works();
}

static void test_forbidden_calls(void **state)
{
    (void)state;
    static const char *const names[] = {
        "open",
        "socket",
        "fork",
        "exec",
        "kill",
        "thread-kill",
        "read",
        "write-elsewhere",
        "executable-memory",
        "shared-memory",
        "file-mapping",
        "executable-later",
        "raise-limit",
        "ptrace",
    };
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        assert_fails(names[i], ERROR_MODEL, "tried what its sandbox forbids");
}

static void test_what_libraries_say_goes_nowhere(void **state)
{
    (void)state;
    struct error error = {0};
    assert_true(run_job("stderr", &JOB_LIMITS, &error));
}

static void test_crashes(void **state)
{
    (void)state;
    assert_fails("crash", ERROR_MODEL, SANITIZED ? "" : "crashed (signal 11)");
    assert_fails("abort", ERROR_MODEL, SANITIZED ? "" : "crashed (signal 6)");
}

static void test_limits(void **state)
{
    (void)state;
    assert_fails("loop", ERROR_MODEL, "more than 1 s of processor time");
    assert_fails("much", ERROR_MODEL, "more than 1 MB");
    if (!SANITIZED)
        assert_fails("allocate", ERROR_MODEL, "no memory (of the 64 MB that it may take)");
    struct error error = {0};
    const struct job_limits short_time = {64 << 20, 1 << 20, 2, 1};
    assert_false(run_job("sleep", &short_time, &error));
    assert_int_equal(error.kind, ERROR_SERVER);
    assert_non_null(strstr(error.text, "not done in 1 s"));
}

static void test_broken_answers(void **state)
{
    (void)state;
    assert_fails("nothing", ERROR_MODEL, "no answer");
    assert_fails("wrong-kind", ERROR_MODEL, "broken answer");
    assert_fails("long-error", ERROR_MODEL, "broken answer");
    struct error error = {0};
    assert_false(run_job("control-characters", &JOB_LIMITS, &error));
    assert_string_equal(error.text, "a?b?c");
}

/* --- while another thread runs a job */

struct running {
    const char *name;
    pthread_t thread;
    bool ok;
    struct error error;
};

static void *run_thread(void *argument)
{
    struct running *running = argument;
    const struct job_limits limits = {64 << 20, 1 << 20, 20, 20};
    running->ok = run_job(running->name, &limits, &running->error);
    return NULL;
}

static void start_job(struct running *running, const char *name)
{
    *running = (struct running){.name = name};
    assert_int_equal(pthread_create(&running->thread, NULL, run_thread, running), 0);
}

static void test_killed_child(void **state)
{
    (void)state;
    struct running running;
    assert_works();
    start_job(&running, "loop");
    pid_t child = child_of(worker_program());
    assert_true(child > 0);
    char path[64];
    snprintf(path, sizeof path, "/proc/%d/fd", child);
    for (int i = 0; i < 500 && count_entries(path) != 2; i++)
        nap();
    /* the child has standard error and the pipe of the answer, no other descriptor */
    assert_int_equal(count_entries(path), 2);
    kill(child, SIGKILL);
    pthread_join(running.thread, NULL);
    assert_false(running.ok);
    assert_int_equal(running.error.kind, ERROR_SERVER);
    assert_non_null(strstr(running.error.text, "was killed"));
    assert_works();
}

static void test_killed_program(void **state)
{
    (void)state;
    pid_t program = worker_program();
    kill(program, SIGKILL);
    assert_works();
    assert_dies(program);
    /* If the program is killed while a job runs, the job is run once more. */
    struct running running;
    start_job(&running, "spin");
    program = worker_program();
    pid_t child = child_of(program);
    assert_true(child > 0);
    kill(program, SIGKILL);
    pthread_join(running.thread, NULL);
    if (!running.ok)
        fail_msg("%s", running.error.text);
    assert_dies(child);
    assert_works();
}

/* A job's process that somebody stops is killed, and the job is run once more. So it is if the program
 * is stopped, which the worker says meanwhile. */
static void test_stopped(void **state)
{
    (void)state;
    struct running running;
    assert_works();
    const pid_t program = worker_program();
    start_job(&running, "spin");
    const pid_t child = child_of(program);
    assert_true(child > 0);
    assert_int_equal(kill(child, SIGSTOP), 0);
    pthread_join(running.thread, NULL);
    if (!running.ok)
        fail_msg("%s", running.error.text);
    assert_dies(child);
    assert_false(is_dead(program));

    assert_int_equal(worker_health(worker), WORKER_WELL);
    assert_int_equal(kill(program, SIGSTOP), 0);
    start_job(&running, "echo");
    while (worker_health(worker) == WORKER_WELL)
        nap();
    assert_int_equal(worker_health(worker), WORKER_SILENT);
    pthread_join(running.thread, NULL);
    if (!running.ok)
        fail_msg("%s", running.error.text);
    assert_dies(program);
    assert_int_equal(worker_health(worker), WORKER_WELL);
}

/* Without its starter a program serves until it ends, and the worker says that it cannot be started
 * again. */
static void test_dead_starter(void **state)
{
    struct worker *before = worker;
    struct error error = {0};
    start_worker(state);
    assert_works();
    pid_t starters[2] = {child_of(getpid()), 0};
    char path[64];
    snprintf(path, sizeof path, "/proc/%d/task/%d/children", getpid(), getpid());
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    assert_int_equal(fscanf(file, "%d %d", &starters[0], &starters[1]),
                     2); /* the older one first */
    fclose(file);
    const pid_t program = child_of(starters[1]);
    assert_int_equal(kill(starters[1], SIGKILL), 0);
    while (worker_health(worker) == WORKER_WELL)
        nap();
    assert_int_equal(worker_health(worker), WORKER_LOST);
    kill(program, SIGKILL);
    assert_dies(program);
    assert_false(run_job("echo", &JOB_LIMITS, &error));
    assert_int_equal(error.kind, ERROR_SERVER);
    worker_destroy(worker);
    worker = before;
}

static void test_many_at_once(void **state)
{
    (void)state;
    struct running running[24];
    for (int i = 0; i < 24; i++)
        start_job(&running[i], i % 3 == 0 ? "echo" : i % 3 == 1 ? "open" : "spin");
    for (int i = 0; i < 24; i++) {
        pthread_join(running[i].thread, NULL);
        assert_int_equal(running[i].ok, i % 3 != 1);
    }
}

static void test_nothing_stays(void **state)
{
    (void)state;
    assert_works();
    int before = count_entries("/proc/self/fd");
    for (int i = 0; i < 20; i++)
        assert_fails(i % 2 ? "open" : "nothing", ERROR_MODEL, "");
    assert_int_equal(count_entries("/proc/self/fd"), before);
    /* The daemon ends while a job runs. */
    struct running running;
    start_job(&running, "loop");
    pid_t program = worker_program(), child = child_of(program);
    assert_true(child > 0);
    worker_stop(worker);
    pthread_join(running.thread, NULL);
    assert_false(running.ok);
    assert_int_equal(running.error.kind, ERROR_SERVER);
    assert_true(kill(program, 0) < 0); /* the program was reaped */
    assert_dies(child);
    worker_destroy(worker);
    assert_int_equal(count_entries("/proc/self/fd"), before - 2); /* to program and starter */
    assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);             /* there is no child left */
    start_worker(NULL);
}

/* Sends this many bytes through a job that returns them; its input is a file that may be reused.
 * Returns the file's inode number. */
static ino_t echo_lent(size_t size)
{
    static uint8_t bytes[WORKER_MAX_SPARE_BYTES + 1];
    const struct job_limits limits = {256 << 20, 256 << 20, 20, 20};
    struct worker_call call;
    struct error error = {0};
    struct stat file;
    memset(bytes, (int)(size % 251), size);
    assert_true(worker_call_init_lent(&call, worker, &error));
    job_write_file(&call.input, "echo", bytes, size);
    if (!worker_run(worker, &call, JOB_READ_CAGE, &limits, "echo", ERROR_MODEL, &error))
        fail_msg("%s", error.text);
    assert_int_equal(call.answer.left, size);
    assert_memory_equal(call.answer.at, bytes, size);
    assert_int_equal(fstat(call.input_fd, &file), 0);
    worker_call_finish(&call);
    return file.st_ino;
}

static void test_inputs_are_lent(void **state)
{
    (void)state;
    assert_works();
    int before = count_entries("/proc/self/fd");
    ino_t first = echo_lent(100000);
    assert_int_equal(echo_lent(999), first); /* nothing of the longer input is left in the file */
    assert_int_equal(echo_lent(WORKER_MAX_SPARE_BYTES + 1), first);
    assert_int_equal(count_entries("/proc/self/fd"), before); /* a file of this size is not kept */
    assert_int_not_equal(echo_lent(5), first);
}

/* Runs a job of this name with a file that an earlier job may have left. */
static bool run_lent(const char *name, struct error *error)
{
    struct worker_call call;
    assert_true(worker_call_init_lent(&call, worker, error));
    job_write_file(&call.input, name, "bytes", 5);
    bool ok = worker_run(worker, &call, JOB_READ_CAGE, &JOB_LIMITS, name, ERROR_MODEL, error);
    worker_call_finish(&call);
    return ok;
}

static void test_an_input_is_cut_and_fixed(void **state)
{
    (void)state;
    struct error error = {0};
    echo_lent(100000); /* leaves a longer file */
    if (!run_lent("input-is-fixed", &error))
        fail_msg("%s", error.text);
    assert_false(run_lent("behind-the-input", &error));
    assert_non_null(strstr(error.text, "crashed (signal 7)")); /* SIGBUS: nothing is there */
}

static bool can_have_namespaces(void)
{
    long pid =
        syscall(SYS_clone, CLONE_NEWUSER | CLONE_NEWNET | CLONE_NEWPID | SIGCHLD, 0, 0, 0, 0);
    if (pid == 0)
        _exit(0);
    return pid > 0 && waitpid((pid_t)pid, NULL, 0) == pid;
}

static void test_a_program_stands_apart(void **state)
{
    (void)state;
    static const char *const kinds[] = {"user", "net", "pid", "mnt", "ipc", "uts"};
    char path[64], ours[64], theirs[64], byte;
    assert_works();
    pid_t program = worker_program();
    for (size_t i = 0; can_have_namespaces() && i < sizeof kinds / sizeof *kinds; i++) {
        snprintf(path, sizeof path, "/proc/self/ns/%s", kinds[i]);
        ssize_t n = readlink(path, ours, sizeof ours);
        snprintf(path, sizeof path, "/proc/%d/ns/%s", program, kinds[i]);
        assert_int_equal(readlink(path, theirs, sizeof theirs), n);
        assert_memory_not_equal(ours, theirs, (size_t)n);
    }
    snprintf(path, sizeof path, "/proc/%d/environ", program);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    while (fread(&byte, 1, 1, file) == 1)
        assert_int_equal(byte, 0);
    fclose(file);
}

/* Asked for its version, the kernel tells whether it has Landlock. */
static bool has_landlock(void)
{
    return syscall(SYS_landlock_create_ruleset, NULL, 0, 1) > 0;
}

static void test_landlock(void **state)
{
    (void)state;
    pid_t pid = fork();
    if (pid == 0) {
        FILE *before = fopen("/proc/self/statm", "r");
        char byte;
        bool ok = before && fopen("/tmp", "r") && access("/proc", R_OK) == 0;
        ok = ok && landlock_enter() == has_landlock();
        ok = ok && fread(&byte, 1, 1, before) == 1;
        if (has_landlock())
            ok = ok && !fopen("/proc/self/statm", "r") && errno == EACCES && !fopen("/tmp", "r") &&
                 mkdir("/tmp/sheen-landlock", 0700) < 0 && errno == EACCES;
        _exit(ok ? 0 : 1);
    }
    int status;
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_int_equal(status, 0);
}

/* A thread that is busy for a while and then waits, like the idle threads of libraries. */
struct busy {
    atomic_bool done;
    pthread_mutex_t lock; /* held by the test until the end */
};

static void *busy_thread(void *argument)
{
    struct busy *busy = argument;
    struct timespec start, now;
    clock_gettime(CLOCK_MONOTONIC, &start);
    do
        clock_gettime(CLOCK_MONOTONIC, &now);
    while ((now.tv_sec - start.tv_sec) * 1000000000L + now.tv_nsec - start.tv_nsec < 100000000L);
    atomic_store(&busy->done, true);
    pthread_mutex_lock(&busy->lock);
    pthread_mutex_unlock(&busy->lock);
    return NULL;
}

static void test_forks_among_idle_threads_only(void **state)
{
    (void)state;
    struct busy busy = {.lock = PTHREAD_MUTEX_INITIALIZER};
    pthread_t thread;
    pthread_mutex_lock(&busy.lock);
    assert_int_equal(pthread_create(&thread, NULL, busy_thread, &busy), 0);
    assert_true(threads_wait_idle());
    assert_true(atomic_load(&busy.done));
    pthread_mutex_unlock(&busy.lock);
    pthread_join(thread, NULL);
}

static void test_no_program(void **state)
{
    (void)state;
    struct error error = {0};
    struct workers workers;
    const struct workers_limits limits = {(uint64_t)1 << 33, (uint64_t)1 << 33, 60, 120};
    assert_false(workers_init(&workers, "/nonexistent", &limits, (uint64_t)1 << 32, &error));
    workers_finish(&workers);
    assert_int_equal(error.kind, ERROR_SERVER);
    assert_non_null(strstr(error.text, "sheend-cage"));
    struct worker *none = worker_create("/etc/passwd", &error);
    assert_non_null(none);
    assert_false(worker_wake(none, &error));
    assert_non_null(strstr(error.text, "cannot start /etc/passwd"));
    worker_destroy(none);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_forbidden_calls),
        cmocka_unit_test(test_what_libraries_say_goes_nowhere),
        cmocka_unit_test(test_crashes),
        cmocka_unit_test(test_limits),
        cmocka_unit_test(test_broken_answers),
        cmocka_unit_test(test_killed_child),
        cmocka_unit_test(test_killed_program),
        cmocka_unit_test(test_stopped),
        cmocka_unit_test(test_dead_starter),
        cmocka_unit_test(test_many_at_once),
        cmocka_unit_test(test_nothing_stays),
        cmocka_unit_test(test_inputs_are_lent),
        cmocka_unit_test(test_an_input_is_cut_and_fixed),
        cmocka_unit_test(test_a_program_stands_apart),
        cmocka_unit_test(test_landlock),
        cmocka_unit_test(test_forks_among_idle_threads_only),
        cmocka_unit_test(test_no_program),
    };
    return cmocka_run_group_tests(tests, start_worker, end_worker);
}
