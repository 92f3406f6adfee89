#include "server/surface/subdivision/quad.h"

#include "server/surface/subdivision/crease.h"
#include "server/surface/subdivision/refine.h"
#include "server/surface/subdivision/ring_cache.h"
#include "server/surface/subdivision/settle.h"

unsigned quad_extraordinary(const struct quad *quad)
{
    unsigned bits = 0;
    for (unsigned i = 0; i < 4; i++)
        bits |= (unsigned)!ring_is_regular(&quad->corner[i]) << i;
    return bits;
}

struct quad quad_rotated(const struct quad *quad, unsigned by)
{
    struct quad out;
    for (unsigned i = 0; i < 4; i++)
        out.corner[i] = quad->corner[(i + by) & 3];
    return out;
}

bool quad_is_semisharp(const struct quad *quad)
{
    for (unsigned i = 0; i < 4; i++)
        if (crease_is_semisharp(&quad->corner[i]))
            return true;
    return false;
}

/* The ring of the new vertex on edge i (corner i to i + 1), starting at corner i + 1. `fine` are
 * the refined rings of the corners. */
static struct ring edge_ring(const struct ring fine[4], unsigned i, struct arena *arena)
{
    const struct ring *from = &fine[i], *to = &fine[(i + 1) & 3];
    uint32_t from_edge = ring_edge_index(from, 0), to_edge = ring_edge_index(to, 1);
    bool closed = ring_has_face(from, -1) && ring_has_face(to, 1);
    bool creased = closed && crease_edge(from, from_edge) + crease_edge(to, to_edge) > 0;
    struct ring ring = ring_take(arena, closed ? 4 : 2, closed, creased);
    ring.centre = from->edge[from_edge];
    ring.edge[0] = to->centre;
    ring.edge[1] = ring_face(from, 0);
    ring.edge[2] = from->centre;
    ring.face[0] = ring_edge(to, 0);
    ring.face[1] = ring_edge(from, 1);
    if (closed) {
        ring.edge[3] = ring_face(from, -1);
        ring.face[2] = ring_edge(from, -1);
        ring.face[3] = ring_edge(to, 2);
    }
    if (creased) {
        ring.creases.chaikin = from->creases.chaikin || to->creases.chaikin;
        ring.creases.edge[0] = crease_edge(to, to_edge);
        ring.creases.far[0] = crease_child(to, to_edge);
        ring.creases.edge[2] = crease_edge(from, from_edge);
        ring.creases.far[2] = crease_child(from, from_edge);
    }
    return ring;
}

static struct ring face_ring(const struct ring fine[4], struct arena *arena)
{
    struct ring ring = ring_take(arena, 4, true, false);
    ring.centre = ring_face(&fine[0], 0);
    for (unsigned k = 0; k < 4; k++) {
        ring.edge[k] = ring_edge(&fine[k], 0);
        ring.face[k] = fine[(k + 1) & 3].centre;
    }
    return ring;
}

static struct ring seen_from(struct ring ring, uint32_t at, struct arena *arena)
{
    ring.at = at;
    return ring_settle(&ring, arena);
}

static struct ring refined(const struct ring *ring, struct arena *arena)
{
    struct ring fine;
    if (!ring_cache_find_derived(ring, RING_REFINED, &fine)) {
        fine = ring_take(arena, ring->n_faces, ring->closed, ring->creases.edge);
        ring_refine(ring, &fine);
        fine = ring_cache_keep_derived(ring, RING_REFINED, &fine);
    }
    fine.at = ring->at;
    return fine;
}

void quad_refine(const struct quad *quad, struct arena *arena, struct quad child[4])
{
    struct ring fine[4], edge[4], face;
    for (unsigned i = 0; i < 4; i++)
        fine[i] = refined(&quad->corner[i], arena);
    for (unsigned i = 0; i < 4; i++)
        edge[i] = edge_ring(fine, i, arena);
    face = face_ring(fine, arena);
    for (unsigned i = 0; i < 4; i++) {
        unsigned before = (i + 3) & 3;
        child[i].corner[i] = ring_settle(&fine[i], arena);
        child[i].corner[(i + 1) & 3] = seen_from(edge[i], 1, arena);
        child[i].corner[(i + 2) & 3] = seen_from(face, before, arena);
        child[i].corner[before] = seen_from(edge[before], 0, arena);
    }
}

/* Two points of the row beyond an edge: the one next to the corner in question, and the next
 * one. */
struct beyond {
    struct vec near, far;
};

/* The phantom point beyond the end of a sector: `edge` is on the end, `inner` one row inside. */
static struct vec mirrored(struct vec edge, struct vec inner)
{
    return vec_sub(vec_scale(edge, 2), inner);
}

static struct beyond beyond_first_edge(const struct ring *ring)
{
    if (ring_has_face(ring, -1))
        return (struct beyond){ring_edge(ring, -1), ring_face(ring, -1)};
    return (struct beyond){mirrored(ring->centre, ring_edge(ring, 1)),
                           mirrored(ring_edge(ring, 0), ring_face(ring, 0))};
}

static struct beyond beyond_second_edge(const struct ring *ring)
{
    if (ring_has_face(ring, 1))
        return (struct beyond){ring_edge(ring, 2), ring_face(ring, 1)};
    return (struct beyond){mirrored(ring->centre, ring_edge(ring, 0)),
                           mirrored(ring_edge(ring, 1), ring_face(ring, 0))};
}

const struct quad_corner quad_corners[4] = {
    {1, 1, 1, 0, 0, 1}, {2, 1, 0, 1, -1, 0}, {2, 2, -1, 0, 0, -1}, {1, 2, 0, -1, 1, 0}};

void quad_grid(const struct quad *quad, struct vec grid[4][4])
{
    for (unsigned i = 0; i < 4; i++) {
        const struct ring *ring = &quad->corner[i];
        const struct quad_corner *at = &quad_corners[i];
        int x = at->x, y = at->y, ax = at->first_x, ay = at->first_y, bx = at->second_x,
            by = at->second_y;
        struct beyond first = beyond_first_edge(ring), second = beyond_second_edge(ring);
        grid[y][x] = ring->centre;
        grid[y - by][x - bx] = first.near;
        grid[y - by + ay][x - bx + ax] = first.far;
        grid[y - ay][x - ax] = second.near;
        grid[y - ay + by][x - ax + bx] = second.far;
        /* The point diagonally beyond an open corner is a phantom: of the row beyond the second
         * edge if only that exists, else of the row beyond the first, which may itself consist of
         * phantoms. */
        bool only_second = !ring_has_face(ring, -1) && ring_has_face(ring, 1);
        struct beyond row = only_second ? second : first;
        grid[y - ay - by][x - ax - bx] =
            ring->closed ? ring_face(ring, 2) : mirrored(row.near, row.far);
    }
}
