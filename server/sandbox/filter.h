/* A list of permitted system calls, from which a seccomp filter is made. The first entry that
 * matches a call decides.
 * Thread: one at a time. */
#ifndef SHEEN_SANDBOX_FILTER_H
#define SHEEN_SANDBOX_FILTER_H

#include <linux/filter.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define FILTER_MAX_CODE 1024

struct filter {
    size_t n;
    struct sock_filter code[FILTER_MAX_CODE];
};

/* What happens to a call: the SECCOMP_RET_ values of the kernel, for SECCOMP_RET_ERRNO with the
 * errno value added. */

/* Begins a list. A call of another architecture than the program's kills the process. */
void filter_init(struct filter *filter);
/* Decides about a system call, whatever its arguments. */
void filter_call(struct filter *filter, long number, uint32_t what);
/* Decides about a system call if the low 32 bits of its argument i (0 to 5), masked, are `value`. */
void filter_call_if(struct filter *filter, long number, unsigned i, uint32_t mask, uint32_t value,
                    uint32_t what);
/* Decides about all other calls, and puts the list into force for ever, for the calling thread and
 * those that it starts. `flags` are the kernel's SECCOMP_FILTER_FLAG_: TSYNC adds all threads of
 * the process. False with errno. */
bool filter_enter(struct filter *filter, uint32_t what, unsigned flags);

#endif
