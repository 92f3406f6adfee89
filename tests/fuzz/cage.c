#include "tests/fuzz/cage.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "server/cage/read/read.h"
#include "server/cage/statistics.h"
#include "server/surface/plan/surface_plan.h"
#include "server/surface/tables.h"
#include "server/sandbox/cage_code.h"
#include "tests/fuzz/fuzz.h"

#define MOST_FACES 40 /* a larger cage takes time and reaches no other code */

static void build_tables(const struct cage *cage)
{
    struct error error = {0};
    struct cage_statistics statistics;
    struct limit_tables tables = {0};
    struct surface_plan plan = {NULL, NULL};
    bool ok = cage_statistics(cage, &statistics, &error) &&
              surface_plan_init(&plan, cage, NULL, &error) &&
              limit_tables_init(&tables, surface_plan_size(&plan), &error) &&
              surface_build_faces(&tables, &plan, 0, tables.n_faces, NULL, &error);
    MUST(ok || error.kind == ERROR_MODEL || (error.kind == ERROR_SERVER && fuzz_memory_failed()));
    surface_plan_finish(&plan);
    limit_tables_finish(&tables);
}

/* An empty array of a cage may be NULL, which memcmp() does not take. */
static bool same_bytes(const void *a, const void *b, size_t size)
{
    return size == 0 || memcmp(a, b, size) == 0;
}

static void check_same(const struct cage *a, const struct cage *b)
{
    MUST(a->n_vertices == b->n_vertices && a->n_faces == b->n_faces);
    MUST(a->n_creases == b->n_creases && a->n_corners == b->n_corners && a->n_holes == b->n_holes);
    MUST(a->scheme == b->scheme && a->boundary == b->boundary && a->chaikin == b->chaikin);
    MUST(a->up == b->up && a->n_patches == b->n_patches);
    MUST(same_bytes(a->patch, b->patch, a->n_patches * sizeof *a->patch));
    MUST(same_bytes(a->position, b->position, a->n_vertices * sizeof *a->position));
    MUST(same_bytes(a->face_vertex, b->face_vertex,
                    a->face_start[a->n_faces] * sizeof *a->face_vertex));
}

/* Writes the cage to a file and reads it again, as it comes from a worker. */
static void hand_over(const struct cage *cage)
{
    struct error error = {0};
    struct cage taken;
    struct sink sink;
    sink_init(&sink, memfd_create("fuzz", MFD_CLOEXEC));
    cage_write(&sink, cage);
    MUST(sink_flush(&sink));
    size_t size = (size_t)lseek(sink.fd, 0, SEEK_END);
    void *bytes = mmap(NULL, size, PROT_READ, MAP_SHARED, sink.fd, 0);
    MUST(bytes != MAP_FAILED);
    struct source source = {bytes, size, true};
    if (cage_take(&source, &taken, "fuzz", &error)) {
        check_same(cage, &taken);
        cage_finish(&taken);
    } else {
        MUST(error.kind == ERROR_SERVER && fuzz_memory_failed());
    }
    munmap(bytes, size);
    close(sink.fd);
}

void fuzz_cage(const void *bytes, size_t size, const char *name)
{
    struct error error = {0};
    struct cage cage;
    if (!cage_read(&cage, bytes, size, name, &error)) {
        MUST(error.text[0]);
        MUST(error.kind == ERROR_MODEL || (error.kind == ERROR_SERVER && fuzz_memory_failed()));
        return;
    }
    hand_over(&cage);
    if (cage.n_faces + cage.n_patches <= MOST_FACES)
        build_tables(&cage);
    cage_finish(&cage);
}
