/* What somebody who has taken over the daemon would try. The arguments of each call are such that
 * the kernel would refuse it with another error than EPERM, or do nothing. */
#include "tests/service/taken_over.h"

#include <errno.h>
#include <fcntl.h>
#include <sched.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

struct call {
    const char *name;
    long number;
    long arguments[6];
    int refusal; /* the expected errno */
    bool of_drivers;
};

#define TEXT(text) ((long)(text))
#define NOWHERE TEXT("/nonexistent/file")

/* Does each call. Those of drivers are permitted to a daemon that draws by one. */
static const struct call CALLS[] = {
    {"execve", SYS_execve, {NOWHERE, 0, 0}, EPERM, false},
    {"execveat", SYS_execveat, {-1, TEXT(""), 0, 0, 0}, EPERM, false},
    {"a process", SYS_clone, {CLONE_SIGHAND}, EPERM, false}, /* without CLONE_VM: EINVAL */
    {"clone3", SYS_clone3, {0, 0}, ENOSYS, false},
    {"signal 0 to the parent", SYS_kill, {1, 0}, EPERM, false},
    {"signal 0 to a thread of another", SYS_tgkill, {1, 1, 0}, EPERM, false},
    {"a signal with a value", SYS_rt_sigqueueinfo, {1, 0, 0}, EPERM, false},
    {"a signal by a descriptor", SYS_fcntl, {-1, F_SETOWN, 1}, EPERM, false},
    {"pidfd_open", SYS_pidfd_open, {-1, 0}, EPERM, false},
    {"ptrace", SYS_ptrace, {PTRACE_PEEKDATA, -1, 0, 0}, EPERM, false},
    {"process_vm_readv", SYS_process_vm_readv, {-1, 0, 0, 0, 0, 0}, EPERM, false},
    {"socket", SYS_socket, {AF_INET, -1, 0}, EPERM, false},
    {"a local socket", SYS_socket, {AF_UNIX, -1, 0}, EPERM, false},
    {"connect", SYS_connect, {-1, 0, 0}, EPERM, false},
    {"bind", SYS_bind, {-1, 0, 0}, EPERM, false},
    {"sendto with an address", SYS_sendto, {-1, 0, 0, 0, NOWHERE, 16}, EPERM, false},
    {"unshare", SYS_unshare, {0}, EPERM, false},
    {"setns", SYS_setns, {-1, 0}, EPERM, false},
    {"mount", SYS_mount, {0, 0, 0, 0, 0}, EPERM, false},
    {"chroot", SYS_chroot, {NOWHERE}, EPERM, false},
    {"setuid", SYS_setuid, {-1}, EPERM, false},
    {"bpf", SYS_bpf, {-1, 0, 0}, EPERM, false},
    {"perf_event_open", SYS_perf_event_open, {0, 0, -1, -1, 0}, EPERM, false},
    {"io_uring_setup", SYS_io_uring_setup, {0, 0}, EPERM, false},
    {"userfaultfd", SYS_userfaultfd, {-1}, EPERM, false},
    {"keyctl", SYS_keyctl, {-1, 0, 0, 0, 0}, EPERM, false},
    {"init_module", SYS_init_module, {0, 0, 0}, EPERM, false},
    {"linkat", SYS_linkat, {-1, NOWHERE, -1, NOWHERE, -1}, EPERM, false},
    {"symlinkat", SYS_symlinkat, {NOWHERE, -1, NOWHERE}, EPERM, false},
    {"mknodat", SYS_mknodat, {-1, NOWHERE, 0, 0}, EPERM, false},
    {"truncate", SYS_truncate, {NOWHERE, 0}, EPERM, false},
    {"a file by openat2", SYS_openat2, {AT_FDCWD, NOWHERE, NOWHERE, 0}, EPERM, false},
    {"a file to write", SYS_openat, {AT_FDCWD, NOWHERE, O_WRONLY}, EPERM, true},
    {"a file to make", SYS_openat, {AT_FDCWD, NOWHERE, O_RDONLY | O_CREAT}, EPERM, true},
    {"a folder to make", SYS_mkdirat, {AT_FDCWD, NOWHERE, 0}, EPERM, true},
    {"ioctl", SYS_ioctl, {-1, 0, 0}, EPERM, true},
    {"memory to execute",
     SYS_mmap,
     {0, 0, PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0},
     EPERM,
     true},
    {"memory made executable", SYS_mprotect, {0, 0, PROT_READ | PROT_EXEC}, EPERM, true},
};

void taken_over(bool has_driver)
{
    const size_t n = sizeof CALLS / sizeof *CALLS;
    size_t n_refused = 0, n_tried = 0;
    for (size_t i = 0; i < n; i++) {
        const struct call *call = &CALLS[i];
        const long *a = call->arguments;
        if (has_driver && call->of_drivers)
            continue;
        errno = 0;
        long result = syscall(call->number, a[0], a[1], a[2], a[3], a[4], a[5]);
        bool is_refused = result == -1 && errno == call->refusal;
        if (!is_refused)
            fprintf(stderr, "permitted: %s (%s)\n", call->name, strerror(errno));
        n_refused += is_refused;
        n_tried++;
    }
    fprintf(stderr, "refused: %zu of %zu calls\n", n_refused, n_tried);
}
