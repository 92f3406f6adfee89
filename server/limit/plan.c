#include "server/limit/plan.h"

#include <stdlib.h>

static bool vertex_is_extraordinary(const struct topology *t, uint32_t corner)
{
    struct sector sector = topology_sector(t, corner);
    bool sharp = t->vertex_flags[corner_vertex(t, corner)] & VERTEX_SHARP;
    struct ring ring = {.n_faces = sector.n_faces, .closed = sector.closed, .sharp = sharp};
    return !ring_is_regular(&ring);
}

/* Boundary mode NONE: faces at a boundary are support only. */
static bool face_is_hole(const struct topology *t, uint32_t face)
{
    if (t->cage->boundary != CAGE_BOUNDARY_NONE)
        return false;
    for (uint32_t c = t->cage->face_start[face]; c < t->cage->face_start[face + 1]; c++)
        if (t->vertex_flags[corner_vertex(t, c)] & VERTEX_BOUNDARY)
            return true;
    return false;
}

static unsigned bit_count(unsigned bits)
{
    return (unsigned)__builtin_popcount(bits);
}

struct plan_shape plan_shape_of(const struct limit_plan *plan, uint32_t ptex)
{
    const struct topology *t = &plan->topology;
    uint32_t c = plan->corner[ptex], face = t->face[c];
    struct plan_shape shape = {LIMIT_HOLE, 0, false};
    if (face_is_hole(t, face))
        return shape;
    bool quad = face_size(t, face) == 4;
    shape.refined = !quad;
    for (unsigned i = 0; i < (quad ? 4 : 1); i++, c = corner_next(t, c)) {
        shape.extraordinary |= (unsigned)vertex_is_extraordinary(t, c) << i;
        shape.refined |= t->vertex_flags[corner_vertex(t, c)] & VERTEX_BY_NGON ? true : false;
    }
    if (!quad)
        shape.extraordinary |= 1u << 2; /* the face point */
    unsigned n = bit_count(shape.extraordinary);
    shape.root = n == 0 ? LIMIT_REGULAR : n == 1 ? LIMIT_CORNER : LIMIT_SPLIT;
    if (quad && shape.refined)
        shape.root = LIMIT_SPLIT;
    return shape;
}

/* How much a Ptex face adds to each array. */
static struct plan_offsets shape_size(struct plan_shape shape)
{
    unsigned corners = bit_count(shape.extraordinary), regular = 0;
    struct plan_offsets size = {0, 0, 0};
    if (shape.root == LIMIT_HOLE)
        return size;
    if (shape.root == LIMIT_SPLIT) {
        size.node = 4;
        regular = 4 - corners;
    } else {
        regular = 1 - corners;
    }
    size.point = corners * LIMIT_CORNER_TEXELS + regular * LIMIT_REGULAR_POINTS;
    size.bound = corners * LIMIT_LEVELS + regular;
    return size;
}

static bool lay_out(struct limit_plan *plan, struct error *error)
{
    uint64_t node = plan->n_ptex, point = 0, bound = 0;
    for (uint32_t p = 0; p <= plan->n_ptex; p++) {
        if (node > INT32_MAX || point > UINT32_MAX)
            return error_set(error, ERROR_MODEL,
                             "the cage needs more than %u table points: split it in parts",
                             UINT32_MAX);
        plan->offsets[p] = (struct plan_offsets){(uint32_t)node, (uint32_t)point, (uint32_t)bound};
        if (p == plan->n_ptex)
            break;
        struct plan_offsets size = shape_size(plan_shape_of(plan, p));
        node += size.node;
        point += size.point;
        bound += size.bound;
    }
    return true;
}

static bool number_ptex_faces(struct limit_plan *plan)
{
    const struct cage *cage = plan->cage;
    size_t n = 0;
    for (uint32_t f = 0; f < cage->n_faces; f++)
        n += face_size(&plan->topology, f) == 4 ? 1 : face_size(&plan->topology, f);
    plan->n_ptex = n;
    plan->first_ptex = malloc(cage->n_faces * sizeof *plan->first_ptex);
    plan->corner = malloc(n * sizeof *plan->corner);
    plan->offsets = malloc((n + 1) * sizeof *plan->offsets);
    if (!plan->first_ptex || !plan->corner || !plan->offsets)
        return false;
    uint32_t ptex = 0;
    for (uint32_t f = 0; f < cage->n_faces; f++) {
        plan->first_ptex[f] = ptex;
        uint32_t start = cage->face_start[f], size = face_size(&plan->topology, f);
        for (uint32_t k = 0; k < (size == 4 ? 1 : size); k++)
            plan->corner[ptex++] = start + k;
    }
    return true;
}

/* What sheen does not evaluate yet is refused by name, never drawn wrong. */
static bool check_supported(const struct cage *cage, struct error *error)
{
    const char *what = NULL;
    if (cage->scheme == CAGE_SCHEME_LOOP)
        what = "the Loop scheme";
    else if (cage->scheme == CAGE_SCHEME_BILINEAR)
        what = "the bilinear scheme";
    else if (cage->n_creases)
        what = "creases";
    else if (cage->n_corners)
        what = "sharp corners (t corner)";
    else if (cage->n_holes)
        what = "holes";
    else if (cage->smooth_triangles)
        what = "smoothtriangles smooth";
    if (what)
        return error_set(error, ERROR_MODEL, "the cage uses %s, which sheen does not evaluate yet",
                         what);
    return true;
}

static bool check_valence(const struct limit_plan *plan, struct error *error)
{
    size_t largest = (extract_points(&plan->topology) / 4 - 1) / 2;
    if (largest > LIMIT_MAX_VALENCE)
        return error_set(error, ERROR_MODEL,
                         "a vertex or face of the cage has %zu neighbours, more than the %d that "
                         "sheen evaluates",
                         largest, LIMIT_MAX_VALENCE);
    return true;
}

struct limit_plan *limit_plan_create(const struct cage *cage, struct error *error)
{
    if (!check_supported(cage, error))
        return NULL;
    struct limit_plan *plan = calloc(1, sizeof *plan);
    if (!plan) {
        error_set(error, ERROR_SERVER, "out of memory");
        return NULL;
    }
    plan->cage = cage;
    if (!topology_init(&plan->topology, cage, error))
        goto fail;
    if (!check_valence(plan, error))
        goto fail;
    if (!number_ptex_faces(plan)) {
        error_set(error, ERROR_SERVER, "out of memory for the Ptex faces of %zu faces",
                  cage->n_faces);
        goto fail;
    }
    if (!plan->topology.quads_only && !refined_points_init(&plan->refined, &plan->topology, error))
        goto fail;
    if (!lay_out(plan, error))
        goto fail;
    /* A quad's rings, those of its children, and the two nets' rings of each corner table. */
    plan->arena_points = 8 * extract_points(&plan->topology) + 128;
    return plan;

fail:
    limit_plan_destroy(plan);
    return NULL;
}

void limit_plan_destroy(struct limit_plan *plan)
{
    if (!plan)
        return;
    topology_finish(&plan->topology);
    refined_points_finish(&plan->refined);
    free(plan->first_ptex);
    free(plan->corner);
    free(plan->offsets);
    free(plan);
}
