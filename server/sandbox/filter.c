#include "server/sandbox/filter.h"

#include <errno.h>
#include <linux/audit.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#if defined(__x86_64__)
#define ARCHITECTURE AUDIT_ARCH_X86_64
#elif defined(__aarch64__)
#define ARCHITECTURE AUDIT_ARCH_AARCH64
#else
#error "the system calls of this processor have not been listed yet"
#endif

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the low half of a number comes first");

static void put(struct filter *filter, struct sock_filter instruction)
{
    if (filter->n < FILTER_MAX_CODE)
        filter->code[filter->n] = instruction;
    filter->n++; /* past the end: filter_enter() refuses */
}

static void load(struct filter *filter, size_t offset)
{
    put(filter, (struct sock_filter)BPF_STMT(BPF_LD | BPF_W | BPF_ABS, (uint32_t)offset));
}

/* Continues if equal, else skips the next n instructions. */
static void if_equal(struct filter *filter, uint32_t value, uint8_t n)
{
    put(filter, (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, value, 0, n));
}

static void decide(struct filter *filter, uint32_t what)
{
    put(filter, (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, what));
}

void filter_init(struct filter *filter)
{
    filter->n = 0;
    load(filter, offsetof(struct seccomp_data, arch));
    put(filter, (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, ARCHITECTURE, 1, 0));
    decide(filter, SECCOMP_RET_KILL_PROCESS);
    /* Numbers of x32 calls differ from all others, so no list has them. */
    load(filter, offsetof(struct seccomp_data, nr));
}

void filter_call(struct filter *filter, long number, uint32_t what)
{
    if_equal(filter, (uint32_t)number, 1);
    decide(filter, what);
}

void filter_call_if(struct filter *filter, long number, unsigned i, uint32_t mask, uint32_t value,
                    uint32_t what)
{
    if_equal(filter, (uint32_t)number, 5);
    load(filter, offsetof(struct seccomp_data, args) + 8 * (size_t)i);
    put(filter, (struct sock_filter)BPF_STMT(BPF_ALU | BPF_AND | BPF_K, mask));
    if_equal(filter, value, 1);
    decide(filter, what);
    load(filter, offsetof(struct seccomp_data, nr)); /* for the entries after this one */
}

bool filter_enter(struct filter *filter, uint32_t what, unsigned flags)
{
    decide(filter, what);
    if (filter->n > FILTER_MAX_CODE) {
        errno = E2BIG;
        return false;
    }
    struct sock_fprog program = {(unsigned short)filter->n, filter->code};
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) < 0)
        return false;
    long stray = syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, flags, &program);
    if (stray > 0)
        errno = EBUSY; /* a thread that has a filter of its own */
    return stray == 0;
}
