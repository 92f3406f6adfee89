#include "server/cage/build/repair.h"

#include <stdlib.h>

#include "server/cage/check.h"

#define GONE UINT32_MAX

/* The number of elements of a kind, and the place of the first. */
struct tally {
    uint32_t count, line, face;
};

struct repair {
    struct cage_builder *builder;
    uint32_t *seen; /* [n_vertices]: 1 + the last face that has the vertex */
    uint32_t *
        face_map; /* [n_faces]: the new index of a face, or GONE; NULL: the cage has no holes to renumber */
    struct tally tally[N_CAGE_FINDINGS];
};

static const struct {
    const char *what, *cost;
} WORDS[N_CAGE_FINDINGS] = {
    [CAGE_FOUND_REPEATED_CORNER] = {"a face names a vertex twice in a row:",
                                    "the second is dropped"},
    [CAGE_FOUND_FEW_CORNERS] = {"a face with fewer than 3 different corners", "is ignored"},
    [CAGE_FOUND_KEYHOLE] = {"a face with a vertex at corners that are no neighbours (a keyhole: "
                            "split it)",
                            "is ignored"},
    [CAGE_FOUND_CREASE] = {"a crease whose vertices share no edge", "is ignored"},
    [CAGE_FOUND_CORNER] = {"a corner tag of a vertex that does not exist", "is ignored"},
    [CAGE_FOUND_HOLE] = {"a hole of a face that does not exist", "is ignored"},
};

static void count(struct repair *repair, enum cage_finding_kind kind, uint32_t line, uint32_t face)
{
    struct tally *tally = &repair->tally[kind];
    if (tally->count++ == 0)
        *tally = (struct tally){1, line, line ? CAGE_NO_FACE : face};
}

/* Copies the corners of a face to `out`, without those equal to a neighbour. Returns how many
 * remain. */
static uint32_t drop_repeated(uint32_t *out, const uint32_t *corner, uint32_t n)
{
    uint32_t kept = 0;
    for (uint32_t c = 0; c < n; c++)
        if (kept == 0 || corner[c] != out[kept - 1])
            out[kept++] = corner[c];
    while (kept > 1 && out[kept - 1] == out[0])
        kept--;
    return kept;
}

static bool repeats_a_vertex(const struct repair *repair, const uint32_t *corner, uint32_t n,
                             uint32_t face)
{
    for (uint32_t c = 0; c < n; c++) {
        if (repair->seen[corner[c]] == face + 1)
            return true;
        repair->seen[corner[c]] = face + 1;
    }
    return false;
}

/* Copies the remaining corners of a face to `out` and returns their number; 0: the face is left
 * out. */
static uint32_t repair_face(struct repair *repair, uint32_t *out, const uint32_t *corner,
                            uint32_t n, uint32_t face)
{
    uint32_t line = repair->builder->face_line[face];
    uint32_t kept = drop_repeated(out, corner, n);
    if (kept < 3) {
        count(repair, CAGE_FOUND_FEW_CORNERS, line, face);
        return 0;
    }
    if (repeats_a_vertex(repair, out, kept, face)) {
        count(repair, CAGE_FOUND_KEYHOLE, line, face);
        return 0;
    }
    if (kept < n)
        count(repair, CAGE_FOUND_REPEATED_CORNER, line, face);
    return kept;
}

static void repair_faces(struct repair *repair)
{
    struct cage_builder *builder = repair->builder;
    struct cage *cage = &builder->cage;
    uint32_t kept_faces = 0, kept_corners = 0, first = 0;
    uint32_t none = 0; /* no face may have a corner, and nothing may be added to a null pointer */
    uint32_t *corners = cage->face_vertex ? cage->face_vertex : &none;
    for (uint32_t f = 0; f < cage->n_faces; f++) {
        uint32_t last = cage->face_start[f + 1];
        uint32_t kept =
            repair_face(repair, corners + kept_corners, corners + first, last - first, f);
        first = last;
        if (repair->face_map)
            repair->face_map[f] = kept ? kept_faces : GONE;
        if (kept == 0)
            continue;
        kept_corners += kept;
        builder->face_line[kept_faces] = builder->face_line[f];
        cage->face_start[++kept_faces] = kept_corners;
    }
    cage->n_faces = kept_faces;
    builder->n_face_vertices = kept_corners;
}

/* Removes the creases with is_edge[] 0. */
static void repair_creases(struct repair *repair, const uint8_t *is_edge)
{
    struct cage_builder *builder = repair->builder;
    struct cage *cage = &builder->cage;
    size_t kept = 0;
    for (size_t i = 0; i < cage->n_creases; i++) {
        if (is_edge[i])
            cage->crease[kept++] = cage->crease[i];
        else
            count(repair, CAGE_FOUND_CREASE, builder->crease_line[i], CAGE_NO_FACE);
    }
    cage->n_creases = kept;
}

static void repair_corners(struct repair *repair)
{
    struct cage_builder *builder = repair->builder;
    struct cage *cage = &builder->cage;
    size_t kept = 0;
    for (size_t i = 0; i < cage->n_corners; i++) {
        if (cage->corner[i].vertex < cage->n_vertices)
            cage->corner[kept++] = cage->corner[i];
        else
            count(repair, CAGE_FOUND_CORNER, builder->corner_line[i], CAGE_NO_FACE);
    }
    cage->n_corners = kept;
}

/* Renumbers holes; the hole of a face that is left out is dropped without a finding. n_faces is the
 * number of faces in the file. */
static void repair_holes(struct repair *repair, size_t n_faces)
{
    struct cage_builder *builder = repair->builder;
    struct cage *cage = &builder->cage;
    size_t kept = 0;
    for (size_t i = 0; i < cage->n_holes; i++) {
        uint32_t face = cage->hole[i];
        if (face >= n_faces)
            count(repair, CAGE_FOUND_HOLE, builder->hole_line[i], CAGE_NO_FACE);
        else if (repair->face_map[face] != GONE)
            cage->hole[kept++] = repair->face_map[face];
    }
    cage->n_holes = kept;
}

static void report(struct repair *repair, const char *name)
{
    struct cage *cage = &repair->builder->cage;
    for (int kind = 0; kind < N_CAGE_FINDINGS; kind++) {
        const struct tally *tally = &repair->tally[kind];
        const struct cage_finding finding = {(enum cage_finding_kind)kind, tally->count,
                                             tally->line, tally->face};
        if (tally->count > 1)
            cage_found(cage, &finding, name, "%s %s; %u in all, this is the first",
                       WORDS[kind].what, WORDS[kind].cost, tally->count);
        else if (tally->count == 1)
            cage_found(cage, &finding, name, "%s %s", WORDS[kind].what, WORDS[kind].cost);
    }
}

/* Fails with the first face and the reason why it is left out. Returns false. */
static bool fail_without_faces(const struct repair *repair, const char *name, size_t n_faces,
                               struct error *error)
{
    const struct tally *few = &repair->tally[CAGE_FOUND_FEW_CORNERS];
    const struct tally *keyhole = &repair->tally[CAGE_FOUND_KEYHOLE];
    bool is_few = few->count > 0 && (keyhole->count == 0 || few->line < keyhole->line ||
                                     (few->line == keyhole->line && few->face < keyhole->face));
    const struct tally *first = is_few ? few : keyhole;
    const char *what = WORDS[is_few ? CAGE_FOUND_FEW_CORNERS : CAGE_FOUND_KEYHOLE].what;
    if (first->line)
        return error_set(error, ERROR_MODEL, "%s:%u: no face of %zu can be drawn; this is %s", name,
                         first->line, n_faces, what);
    return error_set(error, ERROR_MODEL,
                     "%s: no face of %zu can be drawn; face %u (counting from 0) is %s", name,
                     n_faces, first->face, what);
}

bool cage_repair(struct cage_builder *builder, const char *name, struct error *error)
{
    struct cage *cage = &builder->cage;
    size_t n_faces = cage->n_faces;
    if (n_faces == 0)
        return true;
    struct repair repair = {.builder = builder,
                            .seen = calloc(cage->n_vertices + 1, sizeof *repair.seen),
                            .face_map =
                                cage->n_holes ? malloc(n_faces * sizeof *repair.face_map) : NULL};
    uint8_t *is_edge = malloc(cage->n_creases + 1);
    bool ok = repair.seen && (repair.face_map || !cage->n_holes) && is_edge;
    if (ok) {
        repair_faces(&repair);
        ok = cage->n_creases == 0 || cage_find_creases(cage, is_edge);
    }
    if (!ok) {
        error_set(error, ERROR_SERVER, "%s: not enough memory to look through %zu faces", name,
                  n_faces);
    } else if (cage->n_faces == 0) {
        ok = fail_without_faces(&repair, name, n_faces, error);
    } else {
        repair_creases(&repair, is_edge);
        repair_corners(&repair);
        repair_holes(&repair, n_faces);
        report(&repair, name);
    }
    free(repair.seen);
    free(repair.face_map);
    free(is_edge);
    return ok;
}
