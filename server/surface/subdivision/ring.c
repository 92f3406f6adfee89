#include "server/surface/subdivision/ring.h"

#include <string.h>

struct ring ring_take(struct arena *arena, uint32_t n_faces, bool closed, bool with_creases)
{
    struct ring ring = {.n_faces = n_faces, .closed = closed};
    uint32_t n_edges = ring_edges(&ring);
    ring.edge = arena_take(arena, n_edges * sizeof(struct vec));
    ring.face = arena_take(arena, n_faces * sizeof(struct vec));
    if (with_creases) {
        ring.creases.edge = arena_take(arena, 2 * n_edges * sizeof(float));
        ring.creases.far = ring.creases.edge + n_edges;
        memset(ring.creases.edge, 0, 2 * n_edges * sizeof(float));
    }
    return ring;
}

size_t ring_bytes(size_t n_faces, bool with_creases)
{
    size_t points = (2 * n_faces + 1) * sizeof(struct vec);
    return points + (with_creases ? 2 * (n_faces + 1) * sizeof(float) : 0) + 48;
}
