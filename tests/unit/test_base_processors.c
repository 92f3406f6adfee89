/* Processors that a process may use: what the system says, and its control groups. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "server/base/processors.h"
#include "tests/unit/file_tree.h"

static char folder[64];

static int setup(void **state)
{
    (void)state;
    strcpy(folder, "/tmp/sheen-test-XXXXXX");
    return mkdtemp(folder) ? 0 : -1;
}

static int teardown(void **state)
{
    char command[100];
    (void)state;
    snprintf(command, sizeof command, "rm -r %s", folder);
    return system(command);
}

static void put(const char *path, const char *text)
{
    put_below(folder, path, text);
}

static unsigned allowed(cpu_set_t *set)
{
    assert_int_equal(sched_getaffinity(0, sizeof *set, set), 0);
    return (unsigned)CPU_COUNT(set);
}

static void test_affinity(void **state)
{
    cpu_set_t all, one;
    (void)state;
    unsigned n = allowed(&all);
    assert_int_equal(processors_available(folder), n);
    int first = 0;
    while (!CPU_ISSET(first, &all))
        first++;
    CPU_ZERO(&one);
    CPU_SET(first, &one);
    assert_int_equal(sched_setaffinity(0, sizeof one, &one), 0);
    assert_int_equal(processors_available(folder), 1);
    assert_int_equal(sched_setaffinity(0, sizeof all, &all), 0);
    assert_int_equal(processors_available(folder), n);
}

/* A limit of the control group counts where it is below what the system allows. It is rounded up: a
 * little more than 1 processor counts as 2. */
static void test_second_version(void **state)
{
    cpu_set_t all;
    (void)state;
    unsigned n = allowed(&all);
    put("/proc/self/cgroup", "0::/a/b\n");
    const struct {
        const char *text;
        unsigned processors; /* 0: as many as the system allows */
    } cases[] = {
        {"max 100000\n", 0},
        {"50000 100000\n", 1},
        {"100000 100000\n", 1},
        {"100001 100000\n", 2},
        {"1 1000000\n", 1},
        {"0 100000\n", 0},
        {"100000 0\n", 0},
        {"nonsense\n", 0},
        {"-1 100000\n", 0},
        {"6400000 100000\n", 64},
        {"", 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        unsigned wanted = cases[i].processors && cases[i].processors < n ? cases[i].processors : n;
        put("/sys/fs/cgroup/a/b/cpu.max", cases[i].text);
        assert_int_equal(processors_available(folder), wanted);
    }
    /* Limits of the parent group, and of the root group as a container sees it, count as well. */
    put("/sys/fs/cgroup/a/cpu.max", "90000 100000\n");
    assert_int_equal(processors_available(folder), 1);
    put("/sys/fs/cgroup/a/cpu.max", "max 100000\n");
    put("/sys/fs/cgroup/cpu.max", "100000 100000\n");
    assert_int_equal(processors_available(folder), 1);
    put("/sys/fs/cgroup/cpu.max", "max 100000\n");
}

static void test_first_version(void **state)
{
    cpu_set_t all;
    (void)state;
    unsigned n = allowed(&all);
    put("/proc/self/cgroup", "5:memory:/x\n4:cpu,cpuacct:/a/b\nnonsense\n");
    put("/sys/fs/cgroup/cpu/a/b/cpu.cfs_quota_us", "-1\n");
    put("/sys/fs/cgroup/cpu/a/b/cpu.cfs_period_us", "100000\n");
    assert_int_equal(processors_available(folder), n);
    put("/sys/fs/cgroup/cpu/a/b/cpu.cfs_quota_us", "20000\n");
    assert_int_equal(processors_available(folder), 1);
    /* these groups belong to other controllers */
    put("/proc/self/cgroup", "5:memory:/x\n4:cpuset,cpuacct:/a/b\n");
    assert_int_equal(processors_available(folder), n);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_affinity),
                                       cmocka_unit_test(test_second_version),
                                       cmocka_unit_test(test_first_version)};
    return cmocka_run_group_tests(tests, setup, teardown);
}
