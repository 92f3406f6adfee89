#include "server/sandbox/sandbox.h"

#include <errno.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <stddef.h>
#include <stdio.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#if defined(__x86_64__)
#define ARCHITECTURE AUDIT_ARCH_X86_64
#elif defined(__aarch64__)
#define ARCHITECTURE AUDIT_ARCH_AARCH64
#else
#error "the system calls of this processor have not been listed yet"
#endif

#ifdef __SANITIZE_ADDRESS__
enum { HAS_SHADOW = true }; /* AddressSanitizer's shadow needs more memory than any limit */
#else
enum { HAS_SHADOW = false };
#endif

/* --- limits */

static bool limit(__rlimit_resource_t what, uint64_t soft, uint64_t hard)
{
    const struct rlimit value = {soft, hard};
    return setrlimit(what, &value) == 0;
}

bool sandbox_held_bytes(uint64_t *bytes)
{
    FILE *file = fopen("/proc/self/statm", "re");
    if (!file)
        return false;
    unsigned long long pages = 0; /* the sixth number: pages of data and stack */
    bool ok = fscanf(file, "%*u %*u %*u %*u %*u %llu", &pages) == 1;
    fclose(file);
    if (!ok)
        errno = EIO;
    *bytes = pages * (uint64_t)sysconf(_SC_PAGESIZE);
    return ok;
}

bool sandbox_limit(const struct job_limits *limits, uint64_t held_bytes)
{
    uint64_t memory;
    if (__builtin_add_overflow(limits->memory_bytes, held_bytes, &memory)) {
        errno = EINVAL;
        return false;
    }
    /* SIGXCPU reports the reason; SIGKILL follows one second later. */
    return limit(RLIMIT_CORE, 0, 0) && limit(RLIMIT_NOFILE, 0, 0) &&
           limit(RLIMIT_CPU, limits->cpu_s, (uint64_t)limits->cpu_s + 1) &&
           limit(RLIMIT_FSIZE, limits->answer_bytes, limits->answer_bytes) &&
           (HAS_SHADOW || limit(RLIMIT_DATA, memory, memory));
}

/* --- system calls */

/* The low half of argument i. */
#define ARGUMENT(i) (offsetof(struct seccomp_data, args) + 8 * (size_t)(i))
#define LOAD(offset) BPF_STMT(BPF_LD | BPF_W | BPF_ABS, (uint32_t)(offset))
#define MASK(bits) BPF_STMT(BPF_ALU | BPF_AND | BPF_K, (uint32_t)(bits))
#define RETURN(what) BPF_STMT(BPF_RET | BPF_K, (uint32_t)(what))
#define ALLOW RETURN(SECCOMP_RET_ALLOW)
#define KILL RETURN(SECCOMP_RET_KILL_PROCESS)
/* Continues if equal, else skips the next n instructions. */
#define IF_EQUAL(value, n) BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, (uint32_t)(value), 0, n)
#define ALLOW_CALL(number) IF_EQUAL(number, 1), ALLOW
/* Allows a system call if its argument i, masked, equals the value; kills otherwise. */
#define ALLOW_CALL_IF(number, i, mask, value)                                                      \
    IF_EQUAL(number, 5), LOAD(ARGUMENT(i)), MASK(mask), IF_EQUAL(value, 1), ALLOW, KILL

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the low half of a number comes first");

bool sandbox_enter(int answer_fd)
{
    struct sock_filter code[] = {
        LOAD(offsetof(struct seccomp_data, arch)),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, ARCHITECTURE, 1, 0),
        KILL,
        /* Numbers of x32 system calls differ from all below, so they kill. */
        LOAD(offsetof(struct seccomp_data, nr)),
        ALLOW_CALL(SYS_brk),
        ALLOW_CALL(SYS_munmap),
        ALLOW_CALL(SYS_mremap),
        ALLOW_CALL(SYS_madvise),
        ALLOW_CALL(SYS_futex),
        ALLOW_CALL(SYS_getrandom),
        ALLOW_CALL(SYS_clock_gettime),
        ALLOW_CALL(SYS_sysinfo), /* qsort() calls it for the size of memory */
        ALLOW_CALL(SYS_sched_yield),
        ALLOW_CALL(SYS_exit_group),
        /* abort() raises a signal in its own process; no other process can be signalled. */
        ALLOW_CALL(SYS_rt_sigprocmask),
        ALLOW_CALL(SYS_getpid),
        ALLOW_CALL(SYS_gettid),
        ALLOW_CALL_IF(SYS_tgkill, 0, UINT32_MAX, getpid()),
        /* AddressSanitizer calls it before a function ends the process. */
        ALLOW_CALL(HAS_SHADOW ? SYS_sigaltstack : SYS_brk),
        ALLOW_CALL_IF(SYS_mprotect, 2, PROT_EXEC, 0),
        IF_EQUAL(SYS_mmap, 8),
        LOAD(ARGUMENT(2)),
        MASK(PROT_EXEC),
        IF_EQUAL(0, 4),
        LOAD(ARGUMENT(3)),
        MASK(MAP_TYPE | MAP_ANONYMOUS),
        IF_EQUAL(MAP_PRIVATE | MAP_ANONYMOUS, 1),
        ALLOW,
        KILL,
        IF_EQUAL(SYS_write, 5),
        LOAD(ARGUMENT(0)),
        IF_EQUAL(answer_fd, 1),
        ALLOW,
        IF_EQUAL(STDERR_FILENO, 1),
        RETURN(HAS_SHADOW ? SECCOMP_RET_ALLOW : SECCOMP_RET_ERRNO | EBADF),
        KILL,
    };
    struct sock_fprog program = {sizeof code / sizeof *code, code};
    return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
           syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, 0, &program) == 0;
}
