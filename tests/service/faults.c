/* fault_at() of build/sheend-faults. $SHEEN_FAULTS has "NAME:FIRST:TIMES,...": the fault point NAME
 * fails at its FIRST-th call and at each FIRST-th call after it, TIMES times in all. Faults that
 * happen are reported on standard error. Some faults lie outside of sheend's own code: in a thread
 * that builds a model's tables, which at "tables.stuck" never returns, and at "taken.over" (on a GL
 * device "taken.over.gl") tries forbidden system calls; and in the GL driver's compiler, which at
 * "lattice.stuck" never returns from a program for lattices. */
#include "server/base/fault.h"

#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/render/gl/programs/program.h"
#include "server/scene/scene.h"
#include "server/surface/subdivision/build.h"
#include "tests/service/taken_over.h"

enum { MAX_FAULTS = 8 };

static struct fault {
    char name[32];
    unsigned every, times;
    atomic_uint n;
} faults[MAX_FAULTS];
static int n_faults;

/* Runs before main(), while there is one thread. */
__attribute__((constructor)) static void read_faults(void)
{
    const char *at = getenv("SHEEN_FAULTS");
    while (at && *at) {
        struct fault *fault = &faults[n_faults];
        int length = 0;
        if (n_faults == MAX_FAULTS ||
            sscanf(at, "%31[^:,]:%u:%u%n", fault->name, &fault->every, &fault->times, &length) !=
                3 ||
            fault->every == 0) {
            fprintf(stderr, "SHEEN_FAULTS: '%s' is not NAME:EVERY:TIMES\n", at);
            exit(2);
        }
        n_faults++;
        at += length + (at[length] == ',');
    }
}

bool fault_at(const char *name)
{
    for (int i = 0; i < n_faults; i++) {
        struct fault *fault = &faults[i];
        if (strcmp(fault->name, name) != 0)
            continue;
        unsigned n = atomic_fetch_add(&fault->n, 1) + 1;
        if (n % fault->every != 0 || n / fault->every > fault->times)
            return false;
        fprintf(stderr, "fault: %s\n", name);
        return true;
    }
    return false;
}

/* NOLINTBEGIN: the names are the linker's */
__typeof__(limit_build_faces) __real_limit_build_faces, __wrap_limit_build_faces;

bool __wrap_limit_build_faces(struct limit_tables *tables, const struct limit_plan *plan,
                              size_t first, size_t last, const struct limit_watch *watch,
                              struct error *error)
{
    if (fault_at("tables.stuck"))
        sleep(600);
    if (fault_at("taken.over"))
        taken_over(false);
    if (fault_at("taken.over.gl"))
        taken_over(true);
    return __real_limit_build_faces(tables, plan, first, last, watch, error);
}

__typeof__(program_create) __real_program_create, __wrap_program_create;

GLuint __wrap_program_create(const struct program_source *source, struct error *error)
{
    char lattice[32];
    snprintf(lattice, sizeof lattice, "#define PATTERN %d\n", PATTERN_LATTICE);
    if (strstr(source->defines, lattice) && fault_at("lattice.stuck"))
        sleep(600);
    return __real_program_create(source, error);
}
/* NOLINTEND */
