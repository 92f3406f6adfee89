/* Tells which user or group ids the daemon can distinguish in its user namespace: the kernel shows
 * all ids that the namespace does not map as one id, the overflow id.
 *
 * Plain data. Any thread; user_namespace_read() reads two small files of /proc. */
#ifndef SHEEN_NET_USER_NAMESPACE_H
#define SHEEN_NET_USER_NAMESPACE_H

#include <stdbool.h>
#include <stdint.h>

/* The two arguments of user_namespace_read(): for user ids and for group ids. */
#define USER_NAMESPACE_USERS "/proc/self/uid_map", "/proc/sys/kernel/overflowuid"
#define USER_NAMESPACE_GROUPS "/proc/self/gid_map", "/proc/sys/kernel/overflowgid"

struct user_namespace {
    bool is_whole;     /* the namespace maps every id */
    uint32_t overflow; /* the id shown for all unmapped ids */
};

/* Reads the kernel's two files. A map that cannot be read or parsed counts as incomplete. An
 * overflow id that cannot be read (ProcSubset=pid hides it) is the kernel's default, 65534. */
struct user_namespace user_namespace_read(const char *map_path, const char *overflow_path);

/* True if `id` may stand for several ids. */
static inline bool user_namespace_hides(const struct user_namespace *names, uint32_t id)
{
    return !names->is_whole && id == names->overflow;
}

#endif
