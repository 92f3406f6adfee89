#include "server/ops/descriptors.h"

#include <fcntl.h>
#include <sys/resource.h>

enum {
    PER_JOB = 5, /* input twice, answer, and both ends of a pipe */
    OWN = 128,   /* listeners, devices and libraries: more than are used */
    MARGIN = 9,  /* a program that is started again (3), kept input files (4), a client that is
                          turned away, a model's file */
    SCARCE_PROBES = 2, /* where not all have their descriptors */
};

/* The limit after it has been raised as far as the system allows. */
static uint64_t raise_limit(uint64_t n)
{
    struct rlimit files;
    if (getrlimit(RLIMIT_NOFILE, &files) < 0)
        return n;
    if (files.rlim_cur >= n)
        return files.rlim_cur;
    struct rlimit raised = {files.rlim_max < n ? files.rlim_max : n, files.rlim_max};
    return setrlimit(RLIMIT_NOFILE, &raised) == 0 ? raised.rlim_cur : files.rlim_cur;
}

static uint64_t count_used(uint64_t limit)
{
    uint64_t n = 0;
    for (uint64_t fd = 0; fd < limit; fd++)
        n += fcntl((int)fd, F_GETFD) >= 0;
    return n;
}

static uint64_t least(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

struct descriptors descriptors_divide(const struct descriptors *wanted)
{
    uint64_t all = OWN + wanted->clients + (uint64_t)PER_JOB * wanted->jobs + wanted->probes;
    uint64_t limit = raise_limit(all);
    if (limit >= all)
        return *wanted;
    uint64_t kept = count_used(limit) + MARGIN + SCARCE_PROBES;
    uint64_t left = limit > kept ? limit - kept : 0;
    /* Half for jobs, as far as there are so many, and the rest for clients. */
    uint64_t jobs = least(left / 2 / PER_JOB, wanted->jobs);
    jobs = jobs > 0 ? jobs : 1;
    uint64_t clients = left > PER_JOB * jobs ? least(left - PER_JOB * jobs, wanted->clients) : 1;
    return (struct descriptors){clients, (unsigned)jobs,
                                (unsigned)least(SCARCE_PROBES, wanted->probes)};
}
