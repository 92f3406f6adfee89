#include "server/cage/check.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "server/cage/hash.h"

struct check {
    const struct cage *cage;
    const char *name;
    struct error *error;
};

/* Fails with the place of the fault, such as "part.glb: face 11 (counting from 0)", and the
 * text. Returns false. */
__attribute__((format(printf, 4, 5))) static bool fail(const struct check *check, const char *what,
                                                       size_t index, const char *format, ...)
{
    char text[256];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    return error_set(check->error, ERROR_MODEL, "%s: %s %zu (counting from 0) %s", check->name,
                     what, index, text);
}

static bool check_counts(const struct check *check)
{
    const struct cage *cage = check->cage;
    if (cage->n_vertices > CAGE_MAX_VERTICES)
        return error_set(check->error, ERROR_MODEL, "%s: %zu vertices, the most that is read is %u",
                         check->name, cage->n_vertices, CAGE_MAX_VERTICES);
    if (cage->n_faces > CAGE_MAX_FACES)
        return error_set(check->error, ERROR_MODEL, "%s: %zu faces, the most that is read is %u",
                         check->name, cage->n_faces, CAGE_MAX_FACES);
    if (cage->n_patches > CAGE_MAX_PATCHES)
        return error_set(check->error, ERROR_MODEL, "%s: %zu patches, the most that is read is %u",
                         check->name, cage->n_patches, CAGE_MAX_PATCHES);
    if (cage->n_patches > 0 && cage->n_faces > 0)
        return error_set(check->error, ERROR_MODEL,
                         "%s: %zu faces and %zu patches: sheen draws either, give each a file",
                         check->name, cage->n_faces, cage->n_patches);
    if (cage->n_faces == 0 && cage->n_patches == 0)
        return error_set(check->error, ERROR_MODEL,
                         "%s: no face at all (%zu vertices): a cage needs at least one face",
                         check->name, cage->n_vertices);
    if (cage->face_start[0] != 0 || cage->face_start[cage->n_faces] > CAGE_MAX_CORNERS)
        return error_set(check->error, ERROR_MODEL,
                         "%s: %u face corners, the most that is read is %u", check->name,
                         cage->face_start[cage->n_faces], CAGE_MAX_CORNERS);
    return true;
}

/* Checks the position of a vertex, or a point of a patch. */
static bool check_position(const struct check *check, const char *what, size_t index,
                           const double position[3])
{
    for (int i = 0; i < 3; i++) {
        if (!isfinite(position[i]))
            return fail(check, what, index, "has a coordinate %c that is not finite", "xyz"[i]);
        if (fabs(position[i]) > CAGE_MAX_COORDINATE)
            return fail(check, what, index,
                        "has coordinate %c = %g, beyond the largest that is read, %g", "xyz"[i],
                        position[i], CAGE_MAX_COORDINATE);
    }
    return true;
}

static bool check_positions(const struct check *check)
{
    const struct cage *cage = check->cage;
    for (size_t v = 0; v < cage->n_vertices; v++)
        if (!check_position(check, "vertex", v, cage->position[v]))
            return false;
    return true;
}

static bool check_patches(const struct check *check)
{
    const struct cage *cage = check->cage;
    for (size_t i = 0; i < cage->n_patches; i++) {
        if (cage->patch[i].basis >= N_CAGE_BASES)
            return fail(check, "patch", i, "has no known basis");
        for (int k = 0; k < 16; k++)
            if (!check_position(check, "patch", i, cage->patch[i].point[k]))
                return false;
    }
    return true;
}

/* seen[v] is 1 + the last face that has vertex v. */
static bool check_face(const struct check *check, size_t face, uint32_t *seen)
{
    const struct cage *cage = check->cage;
    uint32_t first = cage->face_start[face], last = cage->face_start[face + 1];
    if (last < first || last > cage->face_start[cage->n_faces])
        return fail(check, "face", face, "has a broken corner list");
    if (last - first < 3)
        return fail(check, "face", face, "has %u corner%s, needs at least 3", last - first,
                    last - first == 1 ? "" : "s");
    for (uint32_t c = first; c < last; c++) {
        uint32_t vertex = cage->face_vertex[c];
        if (vertex >= cage->n_vertices)
            return fail(check, "face", face,
                        "has vertex %u (counting from 0) at corner %u, but there are %zu vertices",
                        vertex, c - first + 1, cage->n_vertices);
        if (seen[vertex] == face + 1)
            return fail(check, "face", face,
                        "has vertex %u twice: give every corner its own vertex", vertex);
        seen[vertex] = (uint32_t)face + 1;
    }
    return true;
}

static bool check_faces(const struct check *check)
{
    const struct cage *cage = check->cage;
    uint32_t *seen = calloc(cage->n_vertices ? cage->n_vertices : 1, sizeof *seen);
    if (!seen)
        return error_set(check->error, ERROR_SERVER, "%s: not enough memory to check %zu vertices",
                         check->name, cage->n_vertices);
    bool ok = true;
    for (size_t f = 0; ok && f < cage->n_faces; f++)
        ok = check_face(check, f, seen);
    free(seen);
    return ok;
}

static bool sharpness_is_good(float sharpness)
{
    return isfinite(sharpness) && sharpness >= 0;
}

static bool check_tag_values(const struct check *check)
{
    const struct cage *cage = check->cage;
    for (size_t i = 0; i < cage->n_creases; i++) {
        const struct cage_crease *crease = &cage->crease[i];
        for (int e = 0; e < 2; e++)
            if (crease->vertex[e] >= cage->n_vertices)
                return fail(check, "crease", i,
                            "refers to vertex %u (counting from 0), but there are %zu vertices",
                            crease->vertex[e], cage->n_vertices);
        if (!sharpness_is_good(crease->sharpness))
            return fail(check, "crease", i, "has sharpness %g, needs a number from 0",
                        (double)crease->sharpness);
    }
    for (size_t i = 0; i < cage->n_corners; i++) {
        const struct cage_corner *corner = &cage->corner[i];
        if (corner->vertex >= cage->n_vertices)
            return fail(check, "corner", i,
                        "refers to vertex %u (counting from 0), but there are %zu vertices",
                        corner->vertex, cage->n_vertices);
        if (!sharpness_is_good(corner->sharpness))
            return fail(check, "corner", i, "has sharpness %g, needs a number from 0",
                        (double)corner->sharpness);
    }
    for (size_t i = 0; i < cage->n_holes; i++)
        if (cage->hole[i] >= cage->n_faces)
            return fail(check, "hole", i,
                        "refers to face %u (counting from 0), but there are %zu faces",
                        cage->hole[i], cage->n_faces);
    return true;
}

/* A set of edges by open addressing; sized for the creases, so that a million faces cost only one
 * pass over them. */
struct edge_set {
    uint64_t *edge; /* low vertex << 32 | high vertex; never 0: an edge's high vertex is not 0 */
    uint8_t *found;
    uint64_t mask, seed;
};

static uint64_t edge_key(uint32_t a, uint32_t b)
{
    return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

static size_t edge_slot(const struct edge_set *set, uint64_t key)
{
    size_t slot = (size_t)(hash_mix(key, set->seed) & set->mask);
    while (set->edge[slot] != 0 && set->edge[slot] != key)
        slot = (size_t)((slot + 1) & set->mask);
    return slot;
}

static bool edge_set_init(struct edge_set *set, const struct cage *cage)
{
    size_t slots = 16;
    while (slots < 2 * cage->n_creases)
        slots *= 2;
    set->mask = slots - 1;
    set->seed = hash_seed();
    set->edge = calloc(slots, sizeof *set->edge);
    set->found = calloc(slots, sizeof *set->found);
    if (!set->edge || !set->found)
        return false;
    for (size_t i = 0; i < cage->n_creases; i++) {
        uint64_t key = edge_key(cage->crease[i].vertex[0], cage->crease[i].vertex[1]);
        if (key != 0) /* 0 would be vertex 0 with itself, which no face has as an edge */
            set->edge[edge_slot(set, key)] = key;
    }
    return true;
}

static void mark_face_edges(struct edge_set *set, const uint32_t *vertex, uint32_t n)
{
    for (uint32_t c = 0; c < n; c++) {
        size_t slot = edge_slot(set, edge_key(vertex[c], vertex[c + 1 < n ? c + 1 : 0]));
        if (set->edge[slot] != 0)
            set->found[slot] = 1;
    }
}

static void edge_set_finish(struct edge_set *set)
{
    free(set->edge);
    free(set->found);
}

bool cage_find_creases(const struct cage *cage, uint8_t *is_edge)
{
    struct edge_set set = {0};
    bool ok = edge_set_init(&set, cage);
    for (size_t f = 0; ok && f < cage->n_faces; f++)
        mark_face_edges(&set, &cage->face_vertex[cage->face_start[f]],
                        cage->face_start[f + 1] - cage->face_start[f]);
    for (size_t i = 0; ok && i < cage->n_creases; i++) {
        const uint32_t *vertex = cage->crease[i].vertex;
        is_edge[i] =
            vertex[0] != vertex[1] && set.found[edge_slot(&set, edge_key(vertex[0], vertex[1]))];
    }
    edge_set_finish(&set);
    return ok;
}

/* True if every crease lies on an edge of a face. Indices have been checked. */
static bool check_crease_edges(const struct check *check)
{
    const struct cage *cage = check->cage;
    if (cage->n_creases == 0)
        return true;
    uint8_t *is_edge = malloc(cage->n_creases);
    bool ok = is_edge && cage_find_creases(cage, is_edge);
    if (!ok)
        error_set(check->error, ERROR_SERVER, "%s: not enough memory to check %zu creases",
                  check->name, cage->n_creases);
    for (size_t i = 0; ok && i < cage->n_creases; i++) {
        const uint32_t *vertex = cage->crease[i].vertex;
        if (vertex[0] == vertex[1])
            ok = fail(check, "crease", i, "joins vertex %u (counting from 0) with itself",
                      vertex[0]);
        else if (!is_edge[i])
            ok = fail(check, "crease", i,
                      "joins vertices %u and %u (counting from 0), which no face has as an edge",
                      vertex[0], vertex[1]);
    }
    free(is_edge);
    return ok;
}

bool cage_check(const struct cage *cage, const char *name, struct error *error)
{
    const struct check check = {cage, name ? name : "cage", error};
    return check_counts(&check) && check_positions(&check) && check_faces(&check) &&
           check_patches(&check) && check_tag_values(&check) && check_crease_edges(&check);
}
