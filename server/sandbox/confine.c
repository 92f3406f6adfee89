#include "server/sandbox/confine.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "server/sandbox/filter.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
enum { IS_SANITIZED = true };
#else
enum { IS_SANITIZED = false };
#endif

/* Whatever their arguments. */
static const long FREE_CALLS[] = {
    /* memory, threads that are there, and time */
    SYS_brk,
    SYS_munmap,
    SYS_mremap,
    SYS_madvise,
    SYS_futex,
    SYS_sched_yield,
    SYS_sched_getaffinity,
    SYS_getcpu,
    SYS_membarrier,
    SYS_restart_syscall,
    SYS_rt_sigprocmask,
    SYS_rt_sigreturn,
    SYS_rseq, /* at the end of a thread */
    SYS_getpid,
    SYS_gettid,
    SYS_exit,
    SYS_exit_group,
    SYS_clock_gettime,
    SYS_clock_nanosleep,
    SYS_gettimeofday,
    SYS_nanosleep,
    SYS_getrusage,
    SYS_getrandom,
    SYS_sysinfo,
    SYS_uname,
    /* descriptors that it has */
    SYS_read,
    SYS_write,
    SYS_readv,
    SYS_writev,
    SYS_pread64,
    SYS_pwrite64,
    SYS_lseek,
    SYS_close,
    SYS_fcntl,
    SYS_ftruncate,
    SYS_ppoll,
    SYS_epoll_pwait,
    SYS_epoll_ctl,
    SYS_timerfd_settime,
    SYS_fstat,
    /* clients */
    SYS_accept4,
    SYS_getsockopt,
    SYS_setsockopt,
    SYS_getsockname,
    SYS_getpeername,
    SYS_recvfrom,
    SYS_recvmsg,
    SYS_sendmsg,
    SYS_shutdown,
    /* the ends of the starters of its workers */
    SYS_wait4,
    /* files of jobs, and pipes to hear of their ends */
    SYS_memfd_create,
    SYS_pipe2,
    /* files to read, and the socket's own: its mode at a reload, its end */
    SYS_newfstatat,
    SYS_statx,
    SYS_faccessat,
    SYS_faccessat2,
    SYS_readlinkat,
    SYS_getdents64,
    SYS_fchmodat,
    SYS_unlinkat,
#ifdef __x86_64__ /* newer processors have the calls above alone */
    SYS_poll,
    SYS_epoll_wait,
    SYS_lstat,
    SYS_stat,
    SYS_access,
    SYS_readlink,
    SYS_chmod,
    SYS_unlink,
#endif
};

/* What drivers need beyond that. */
static const long DRIVER_CALLS[] = {
    SYS_mmap,
    SYS_mprotect,
    SYS_openat,
    SYS_ioctl,
    /* threads: set-up of a new one */
    SYS_set_robust_list,
    SYS_sched_setaffinity,
    SYS_sched_getparam,
    SYS_sched_getscheduler,
    SYS_sched_setscheduler,
    SYS_sched_get_priority_max,
    SYS_sched_get_priority_min,
    SYS_setpriority,
    SYS_getpriority,
    SYS_rt_sigaction,
    SYS_sigaltstack,
    /* the cache of shaders */
    SYS_mkdirat,
    SYS_renameat,
    SYS_renameat2,
    SYS_flock,
    SYS_fallocate,
    SYS_fadvise64,
    SYS_fsync,
    SYS_utimensat,
    SYS_getcwd,
    SYS_fstatfs,
    SYS_statfs,
    /* who and where the process is, and what it may take */
    SYS_getuid,
    SYS_geteuid,
    SYS_getgid,
    SYS_getegid,
    SYS_getppid,
    SYS_mincore,
    SYS_mlock,
    SYS_munlock,
    SYS_kcmp,
    /* descriptors of buffers and fences */
    SYS_dup,
    SYS_dup3,
    SYS_eventfd2,
    SYS_epoll_create1,
    SYS_pselect6,
    SYS_timerfd_create,
#ifdef __x86_64__
    SYS_mkdir,
    SYS_rename,
    SYS_rmdir,
    SYS_getrlimit,
    SYS_dup2,
    SYS_select,
#endif
};

/* What the sanitizers' run-time libraries need beyond that, for example to look for leaks. */
static const long SANITIZER_CALLS[] = {
    SYS_mmap,        SYS_mprotect, SYS_openat,       SYS_clone, SYS_ptrace,          SYS_prctl,
    SYS_sigaltstack, SYS_getppid,  SYS_rt_sigaction, SYS_kill,  SYS_set_robust_list, SYS_rseq,
    SYS_ioctl,       SYS_mincore,  SYS_getdents64,
#ifdef __x86_64__
    SYS_open,        SYS_pipe,     SYS_getdents,
#endif
};

#define ALLOW_ALL(filter, calls)                                                                   \
    for (size_t i = 0; i < sizeof(calls) / sizeof *(calls); i++)                                   \
    filter_call(filter, (calls)[i], SECCOMP_RET_ALLOW)

static void decide_by_arguments(struct filter *filter, enum confine_kind kind)
{
    const uint32_t allow = SECCOMP_RET_ALLOW, all = UINT32_MAX;
    const uint32_t refuse = SECCOMP_RET_ERRNO | EPERM;
    /* A descriptor that becomes ready could send a signal to any process. */
    filter_call_if(filter, SYS_fcntl, 1, all, F_SETOWN, refuse);
    filter_call_if(filter, SYS_fcntl, 1, all, F_SETOWN_EX, refuse);
    filter_call_if(filter, SYS_fcntl, 1, all, F_SETSIG, refuse);
    /* Of itself alone: abort(), and its limits. */
    filter_call_if(filter, SYS_tgkill, 0, all, (uint32_t)getpid(), allow);
    filter_call_if(filter, SYS_prlimit64, 0, all, 0, allow);
    filter_call_if(filter, SYS_socketpair, 0, all, AF_UNIX, allow);
    /* Without an address, so to a peer that it has. */
    filter_call_if(filter, SYS_sendto, 5, all, 0, allow);
    filter_call_if(filter, SYS_prctl, 0, all, PR_SET_NAME, allow);
    if (kind == CONFINE_COMPUTING) {
        filter_call_if(filter, SYS_mmap, 2, PROT_EXEC, 0, allow);
        filter_call_if(filter, SYS_mprotect, 2, PROT_EXEC, 0, allow);
        filter_call_if(filter, SYS_openat, 2, O_ACCMODE | O_CREAT | O_TRUNC, O_RDONLY, allow);
    } else {
        /* A thread, in none but this process's namespaces. */
        const uint32_t apart = CLONE_NEWNS | CLONE_NEWUSER | CLONE_NEWPID | CLONE_NEWNET |
                               CLONE_NEWIPC | CLONE_NEWUTS | CLONE_NEWCGROUP;
        filter_call_if(filter, SYS_clone, 0, CLONE_THREAD | apart, CLONE_THREAD, allow);
    }
}

bool confine_enter(enum confine_kind kind)
{
    struct filter filter;
    filter_init(&filter);
    decide_by_arguments(&filter, kind);
    ALLOW_ALL(&filter, FREE_CALLS);
    /* Its arguments lie in memory, where no filter can look: libraries then call clone(). */
    filter_call(&filter, SYS_clone3, SECCOMP_RET_ERRNO | ENOSYS);
    if (kind == CONFINE_DRIVER)
        ALLOW_ALL(&filter, DRIVER_CALLS);
    if (IS_SANITIZED)
        ALLOW_ALL(&filter, SANITIZER_CALLS);
    return filter_enter(&filter, SECCOMP_RET_ERRNO | EPERM,
                        SECCOMP_FILTER_FLAG_TSYNC | SECCOMP_FILTER_FLAG_LOG);
}
