/* Writes a report of tests as JUnit XML, as build servers read it: valid by the schemas of both Jenkins and Ant.
 * Thread: any. */
#ifndef SHEEN_CLIENT_JUNIT_H
#define SHEEN_CLIENT_JUNIT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct junit_case {
    const char *name;
    const char *failure; /* one line; NULL: the case has passed */
    const char *details; /* lines below the failure; NULL: none */
    bool is_error;       /* the failure is that the test could not be run */
};

struct junit_suite {
    const char *name;
    const struct junit_case *cases;
    size_t n_cases;
    double seconds; /* of all cases */
};

/* The report as malloc'd text of *n_bytes; NULL when memory is short. Texts may hold any bytes: what XML cannot hold
 * (control characters, malformed UTF-8) becomes U+FFFD. `when_s` is the time of the tests since 1970, UTC. */
char *junit_write(const struct junit_suite *suites, size_t n_suites, int64_t when_s,
                  size_t *n_bytes);

#endif
