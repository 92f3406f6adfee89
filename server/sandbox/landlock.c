#include "server/sandbox/landlock.h"

#include <stddef.h>
#include <stdint.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

/* The system's header may be older than the kernel, so the numbers are here: those of
 * linux/landlock.h. */
enum { ASK_VERSION = 1 };

struct ruleset {
    uint64_t files, net,
        scoped; /* rights that are denied unless a rule grants them; there is none */
};

static uint64_t first_bits(unsigned n)
{
    return (UINT64_C(1) << n) - 1;
}

/* All rights that this version knows, and the size of the struct that it takes. */
static struct ruleset all_of(long version, size_t *size)
{
    const unsigned n_files = version >= 5 ? 16 : version >= 3 ? 15 : version == 2 ? 14 : 13;
    *size = version >= 6   ? sizeof(struct ruleset)
            : version >= 4 ? offsetof(struct ruleset, scoped)
                           : offsetof(struct ruleset, net);
    return (struct ruleset){.files = first_bits(n_files),
                            .net = version >= 4 ? first_bits(2) : 0,
                            .scoped = version >= 6 ? first_bits(2) : 0};
}

bool landlock_enter(void)
{
    size_t size;
    const long version = syscall(SYS_landlock_create_ruleset, NULL, 0, ASK_VERSION);
    if (version < 1)
        return false;
    const struct ruleset all = all_of(version, &size);
    const int fd = (int)syscall(SYS_landlock_create_ruleset, &all, size, 0);
    if (fd < 0)
        return false;
    const bool ok = prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
                    syscall(SYS_landlock_restrict_self, fd, 0) == 0;
    close(fd);
    return ok;
}
