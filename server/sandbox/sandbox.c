#include "server/sandbox/sandbox.h"

#include <errno.h>
#include <linux/seccomp.h>
#include <stdio.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "server/sandbox/filter.h"

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

/* Whatever their arguments. */
static const long FREE_CALLS[] = {
    SYS_brk,
    SYS_munmap,
    SYS_mremap,
    SYS_madvise,
    SYS_futex,
    SYS_getrandom,
    SYS_clock_gettime,
    SYS_sysinfo, /* qsort() calls it for the size of memory */
    SYS_sched_yield,
    SYS_exit_group,
    /* abort() raises a signal in its own process */
    SYS_rt_sigprocmask,
    SYS_getpid,
    SYS_gettid,
    /* AddressSanitizer calls it before a function ends the process. */
    HAS_SHADOW ? SYS_sigaltstack : SYS_brk,
};

bool sandbox_enter(int answer_fd)
{
    struct filter filter;
    const uint32_t allow = SECCOMP_RET_ALLOW, all = UINT32_MAX;
    filter_init(&filter);
    for (size_t i = 0; i < sizeof FREE_CALLS / sizeof *FREE_CALLS; i++)
        filter_call(&filter, FREE_CALLS[i], allow);
    filter_call_if(&filter, SYS_tgkill, 0, all, (uint32_t)getpid(), allow);
    filter_call_if(&filter, SYS_mprotect, 2, PROT_EXEC, 0, allow);
    filter_call_if(&filter, SYS_mmap, 2, PROT_EXEC, PROT_EXEC, SECCOMP_RET_KILL_PROCESS);
    filter_call_if(&filter, SYS_mmap, 3, MAP_TYPE | MAP_ANONYMOUS, MAP_PRIVATE | MAP_ANONYMOUS,
                   allow);
    filter_call_if(&filter, SYS_write, 0, all, (uint32_t)answer_fd, allow);
    filter_call_if(&filter, SYS_write, 0, all, STDERR_FILENO,
                   HAS_SHADOW ? allow : SECCOMP_RET_ERRNO | EBADF);
    return filter_enter(&filter, SECCOMP_RET_KILL_PROCESS, 0);
}
