/* Which user or group ids the daemon can tell apart, by the user namespace that it runs in: the
 * kernel shows every id that the namespace does not map as one and the same, the overflow id.
 *
 * Plain data. Thread: any; user_namespace_read() reads two small files of /proc. */
#ifndef SHEEN_NET_USER_NAMESPACE_H
#define SHEEN_NET_USER_NAMESPACE_H

#include <stdbool.h>
#include <stdint.h>

#define USER_NAMESPACE_USERS "/proc/self/uid_map", "/proc/sys/kernel/overflowuid"
#define USER_NAMESPACE_GROUPS "/proc/self/gid_map", "/proc/sys/kernel/overflowgid"

struct user_namespace {
    bool is_whole;     /* every id is mapped */
    uint32_t overflow; /* what the others look like */
};

/* Both files are the kernel's. A map that cannot be read, or is not of its form, is not whole; an
 * overflow id that cannot be read (ProcSubset=pid hides it) is the kernel's default, 65534. */
struct user_namespace user_namespace_read(const char *map_path, const char *overflow_path);

/* May this be any of several ids? */
static inline bool user_namespace_hides(const struct user_namespace *names, uint32_t id)
{
    return !names->is_whole && id == names->overflow;
}

#endif
