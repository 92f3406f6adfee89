/* A worker whose parser was taken over by an attacker. The name of the "file" chooses what it
 * tries. If the sandbox lets an attempt pass, the answer says so. */
#include <errno.h>
#include <fcntl.h>
#include <linux/futex.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include "server/sandbox/zygote.h"

/* --- attempts that the sandbox must prevent */

static void try_open(void)
{
    open("/etc/passwd", O_RDONLY);
}

static void try_socket(void)
{
    socket(AF_INET, SOCK_STREAM, 0);
}

static void try_fork(void)
{
    syscall(SYS_clone, 17, 0, 0, 0, 0); /* SIGCHLD: like fork() */
}

static void try_exec(void)
{
    char *const none[] = {NULL};
    execve("/bin/true", none, none);
}

static void try_kill(void)
{
    syscall(SYS_kill, -1, 0);
}

static void try_thread_kill(void)
{
    syscall(SYS_tgkill, 1, 1, 0);
}

static void try_read(void)
{
    char byte;
    if (read(2, &byte, 1) < 0)
        return;
}

static void try_write_elsewhere(void)
{
    if (write(1, "x", 1) < 0)
        return;
}

static void try_executable_memory(void)
{
    mmap(NULL, 4096, PROT_READ | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
}

static void try_executable_later(void)
{
    void *page = mmap(NULL, 4096, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    mprotect(page, 4096, PROT_READ | PROT_EXEC);
}

static void try_shared_memory(void)
{
    mmap(NULL, 4096, PROT_READ, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
}

static void try_file_mapping(void)
{
    mmap(NULL, 4096, PROT_READ, MAP_PRIVATE, 3, 0);
}

static void try_raise_limit(void)
{
    const struct rlimit all = {RLIM_INFINITY, RLIM_INFINITY};
    setrlimit(RLIMIT_DATA, &all);
}

static void try_ptrace(void)
{
    syscall(SYS_ptrace, 16, getppid(), 0, 0);
}

static void try_crash(void)
{
    volatile int *nowhere = NULL;
    *nowhere = 1;
}

static void try_loop(void)
{
    for (volatile unsigned i = 0;; i++)
        ;
}

/* Waits without using processor time. */
static void try_sleep(void)
{
    int word = 0;
    syscall(SYS_futex, &word, FUTEX_WAIT_PRIVATE, 0, NULL, NULL, 0);
}

static const struct {
    const char *name;
    void (*attempt)(void);
} ATTEMPTS[] = {
    {"open", try_open},
    {"socket", try_socket},
    {"fork", try_fork},
    {"exec", try_exec},
    {"kill", try_kill},
    {"thread-kill", try_thread_kill},
    {"read", try_read},
    {"write-elsewhere", try_write_elsewhere},
    {"executable-memory", try_executable_memory},
    {"executable-later", try_executable_later},
    {"shared-memory", try_shared_memory},
    {"file-mapping", try_file_mapping},
    {"raise-limit", try_raise_limit},
    {"ptrace", try_ptrace},
    {"crash", try_crash},
    {"abort", abort},
    {"loop", try_loop},
    {"sleep", try_sleep},
};

/* --- answers */

static void answer_much(struct sink *answer)
{
    static const uint8_t zeros[4096];
    answer_write_ok(answer);
    while (answer->ok)
        sink_bytes(answer, zeros, sizeof zeros);
}

/* Allocates until memory runs out, and then reports that, like a parser. */
static void answer_allocate(struct sink *answer)
{
    struct error error = {0};
    for (char *block; (block = malloc(1 << 20));)
        memset(block, 1, 1 << 20);
    error_set(&error, ERROR_SERVER, "allocate: no memory");
    answer_write_error(answer, &error);
}

/* The page in which the job's input begins. */
static uint8_t *input_page;

/* Says yes when the input can be neither written nor taken away from the daemon's file. */
static void answer_input_is_fixed(struct sink *answer)
{
    struct error error = {0};
    bool writable = mprotect(input_page, 4096, PROT_READ | PROT_WRITE) == 0;
    bool removable = madvise(input_page, 4096, MADV_REMOVE) == 0;
    error_set(&error, ERROR_MODEL, "writable %d, removable %d", writable, removable);
    if (writable || removable)
        answer_write_error(answer, &error);
    else
        answer_write_ok(answer);
}

/* Reads behind its input, where an earlier job may have left something. */
static void answer_behind_the_input(struct sink *answer)
{
    const uint8_t *more = mremap(input_page, 4096, 1 << 20, MREMAP_MAYMOVE);
    answer_write_ok(answer);
    if (more != MAP_FAILED)
        sink_bytes(answer, more + 4096, 4096);
}

/* Computes for a second. */
static void answer_spin(struct sink *answer)
{
    struct timespec start, now;
    clock_gettime(CLOCK_MONOTONIC, &start);
    do
        clock_gettime(CLOCK_MONOTONIC, &now);
    while ((now.tv_sec - start.tv_sec) * 1000000000L + now.tv_nsec - start.tv_nsec < 1000000000L);
    answer_write_ok(answer);
}

static void answer_stderr(struct sink *answer)
{
    fprintf(stderr, "a library says something\n");
    answer_write_ok(answer);
}

static void answer_wrong_kind(struct sink *answer)
{
    sink_u32(answer, 99);
    sink_text(answer, "text");
}

static void answer_long_error(struct sink *answer)
{
    sink_u32(answer, ERROR_MODEL);
    sink_u32(answer, UINT32_MAX);
    sink_bytes(answer, "text", 4);
}

static void answer_control_characters(struct sink *answer)
{
    sink_u32(answer, ERROR_MODEL);
    sink_text(answer, "a\nb\033c");
}

static void answer_nothing(struct sink *answer)
{
    (void)answer;
}

static const struct {
    const char *name;
    void (*answer)(struct sink *answer);
} ANSWERS[] = {
    {"much", answer_much},
    {"allocate", answer_allocate},
    {"spin", answer_spin},
    {"input-is-fixed", answer_input_is_fixed},
    {"behind-the-input", answer_behind_the_input},
    {"stderr", answer_stderr},
    {"wrong-kind", answer_wrong_kind},
    {"long-error", answer_long_error},
    {"control-characters", answer_control_characters},
    {"nothing", answer_nothing},
};

static void run(struct source *input, struct sink *answer)
{
    const char *name;
    size_t size;
    input_page = (uint8_t *)((uintptr_t)input->at & ~(uintptr_t)4095);
    const void *bytes = job_take_file(input, &name, &size);
    for (size_t i = 0; i < sizeof ATTEMPTS / sizeof *ATTEMPTS; i++)
        if (strcmp(name, ATTEMPTS[i].name) == 0)
            ATTEMPTS[i].attempt();
    for (size_t i = 0; i < sizeof ANSWERS / sizeof *ANSWERS; i++)
        if (strcmp(name, ANSWERS[i].name) == 0) {
            ANSWERS[i].answer(answer);
            return;
        }
    answer_write_ok(answer);
    sink_bytes(answer, bytes, size);
}

int main(int argc, char **argv)
{
    static const struct zygote_task tasks[N_JOB_KINDS] = {[JOB_READ_CAGE] = {run}};
    return zygote_main(argc, argv, tasks);
}
