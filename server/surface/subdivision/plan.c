#include "server/surface/subdivision/plan.h"

#include <stdlib.h>
#include <string.h>

#include "server/surface/topology/nonmanifold.h"
#include "server/surface/topology/topology.h"

/* Boundary mode NONE: faces at a boundary have no surface, unless all boundary edges at their
 * vertices are sharp by themselves (OpenSubdiv sdc/options.h). */
static bool lacks_boundary(const struct topology *t, uint32_t face)
{
    for (uint32_t c = t->cage->face_start[face]; c < t->cage->face_start[face + 1]; c++)
        if (t->vertex_flags[corner_vertex(t, c)] & VERTEX_UNBOUND)
            return true;
    return false;
}

static bool mark_holes(struct limit_plan *plan)
{
    const struct cage *cage = plan->cage;
    if (!cage->n_holes && cage->boundary != CAGE_BOUNDARY_NONE)
        return true;
    plan->hole = calloc(cage->n_faces, 1);
    if (!plan->hole)
        return false;
    for (size_t i = 0; i < cage->n_holes; i++)
        plan->hole[cage->hole[i]] = 1;
    for (uint32_t f = 0; f < cage->n_faces && cage->boundary == CAGE_BOUNDARY_NONE; f++)
        plan->hole[f] |= lacks_boundary(&plan->topology, f);
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

/* What sheen does not support is refused by name, never drawn wrong. */
static bool check_supported(const struct cage *cage, struct error *error)
{
    const char *what = cage->scheme == CAGE_SCHEME_LOOP       ? "the Loop scheme"
                       : cage->scheme == CAGE_SCHEME_BILINEAR ? "the bilinear scheme"
                                                              : NULL;
    return !what || error_set(error, ERROR_MODEL,
                              "the cage uses %s, which sheen does not evaluate yet", what);
}

static bool check_valence(struct limit_plan *plan, struct error *error)
{
    size_t largest = extract_largest_ring(&plan->topology);
    if (largest > LIMIT_MAX_VALENCE)
        return error_set(error, ERROR_MODEL,
                         "a vertex or face of the cage has %zu neighbours, more than the %d that "
                         "sheen evaluates",
                         largest, LIMIT_MAX_VALENCE);
    /* Room for a face's rings, two more for each extraction, and for each of at most 12 depths the
     * refined rings, the settled ones, and those of a table's two nets. At each depth only one ring
     * is large. */
    plan->arena_bytes = 48 * ring_bytes(largest, true) + 12 * 32 * ring_bytes(4, true);
    return true;
}

static bool refine_if_needed(struct limit_plan *plan, const struct limit_watch *watch,
                             struct error *error)
{
    if (plan->topology.quads_only)
        return true;
    struct arena arena;
    if (!arena_init(&arena, plan->arena_bytes))
        return error_set(error, ERROR_SERVER, "out of memory for the refined cage");
    bool ok = refined_points_init(&plan->refined, &plan->topology, &arena, watch, error);
    arena_finish(&arena);
    return ok;
}

static void *copy_of(const void *from, size_t n, size_t size)
{
    void *to = malloc(n * size);
    if (to)
        memcpy(to, from, n * size);
    return to;
}

/* Copies vertices and faces: afterwards nothing else of the cage is read. */
static bool keep_cage(struct limit_plan *plan, const struct cage *cage)
{
    size_t n_corners = cage->face_start[cage->n_faces];
    plan->copy = (struct cage){
        .n_vertices = cage->n_vertices,
        .position = copy_of(cage->position, cage->n_vertices, sizeof *cage->position),
        .n_faces = cage->n_faces,
        .face_start = copy_of(cage->face_start, cage->n_faces + 1, sizeof *cage->face_start),
        .face_vertex = copy_of(cage->face_vertex, n_corners, sizeof *cage->face_vertex),
        .scheme = cage->scheme,
        .boundary = cage->boundary,
        .chaikin = cage->chaikin,
        .smooth_triangles = cage->smooth_triangles,
    };
    plan->cage = plan->topology.cage = &plan->copy;
    return plan->copy.position && plan->copy.face_start && plan->copy.face_vertex;
}

bool plan_init(struct limit_plan *plan, const struct cage *cage, const struct limit_watch *watch,
               struct error *error)
{
    *plan = (struct limit_plan){.n_users = 1, .cage = cage};
    if (!check_supported(cage, error) || !topology_init(&plan->topology, cage, error) ||
        !check_valence(plan, error))
        return false;
    if (!number_ptex_faces(plan) || !mark_holes(plan))
        return error_set(error, ERROR_SERVER, "out of memory for the Ptex faces of %zu faces",
                         cage->n_faces);
    if (!keep_cage(plan, cage))
        return error_set(error, ERROR_SERVER, "out of memory for the cage of %zu faces",
                         cage->n_faces);
    return refine_if_needed(plan, watch, error);
}

size_t plan_bytes(const struct limit_plan *plan)
{
    const struct cage *cage = plan->cage;
    const struct topology *t = &plan->topology;
    size_t n_corners = cage->face_start[cage->n_faces];
    size_t per_corner = sizeof *cage->face_vertex + sizeof *t->twin + sizeof *t->face +
                        (t->edge_sharpness ? sizeof *t->edge_sharpness : 0) +
                        (t->child_sharpness ? sizeof *t->child_sharpness : 0) +
                        (plan->refined.edge ? sizeof *plan->refined.edge : 0);
    size_t per_vertex = sizeof *cage->position + sizeof *t->vertex_flags +
                        (t->vertex_sharpness ? sizeof *t->vertex_sharpness : 0) +
                        (plan->refined.vertex ? sizeof *plan->refined.vertex : 0);
    size_t per_face = sizeof *cage->face_start + sizeof *plan->first_ptex + (plan->hole ? 1 : 0) +
                      (plan->refined.face ? sizeof *plan->refined.face : 0);
    return sizeof *plan + n_corners * per_corner + cage->n_vertices * per_vertex +
           cage->n_faces * per_face +
           plan->n_ptex * (sizeof *plan->corner + sizeof *plan->offsets) +
           t->n_nonmanifold * sizeof *t->nonmanifold +
           t->n_vertex_creases * sizeof *t->vertex_creases + plan->arena_bytes;
}

void plan_finish(struct limit_plan *plan)
{
    topology_finish(&plan->topology);
    refined_points_finish(&plan->refined);
    dart_mask_list_finish(&plan->darts);
    free(plan->first_ptex);
    free(plan->corner);
    free(plan->hole);
    free(plan->offsets);
    cage_finish(&plan->copy);
    *plan = (struct limit_plan){0};
}
