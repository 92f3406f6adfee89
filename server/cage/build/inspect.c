#include "server/cage/build/inspect.h"

#include <stdlib.h>

#include "server/cage/hash.h"
#include "server/cage/build/bodies.h"
#include "server/cage/edges.h"
#include "server/cage/joints.h"

enum {
    /* The face has an edge with more than two faces, or with two in the same direction. */
    TANGLED = 1,
    REPEATED = 2, /* the face repeats an earlier one */
    OPEN = 4,     /* the face has an edge that a closed body cannot have */
};

struct inspection {
    struct cage *cage;
    const struct cage_builder *builder;
    const char *name;
    struct cage_edges edges;
    uint32_t *face_of; /* [corners] */
    uint8_t *flags;    /* [n_faces] */
    /* [n_faces]: number of edges that a neighbour traverses in the same direction. */
    uint32_t *against;
    uint32_t *body; /* [n_faces]: union-find of the faces that edges join */
    uint32_t n_against;
};

static struct cage_finding at_face(const struct inspection *inspection, enum cage_finding_kind kind,
                                   uint32_t count, uint32_t face)
{
    uint32_t line = inspection->builder->face_line[face];
    return (struct cage_finding){kind, count, line, line ? CAGE_NO_FACE : face};
}

/* --- faces that share no vertex */

static int compare_places(const void *a, const void *b)
{
    const double *p = a, *q = b;
    for (int i = 0; i < 3; i++)
        if (p[i] != q[i])
            return p[i] < q[i] ? -1 : 1;
    return 0;
}

static bool no_vertex_is_shared(const struct cage *cage, uint8_t *is_used)
{
    for (uint32_t c = 0; c < cage->face_start[cage->n_faces]; c++) {
        if (is_used[cage->face_vertex[c]])
            return false;
        is_used[cage->face_vertex[c]] = 1;
    }
    return true;
}

/* Counts the corners whose position equals that of another corner, minus one for each such
 * position. False: no memory. */
static bool count_repeated_places(const struct cage *cage, uint32_t *count)
{
    size_t n = cage->face_start[cage->n_faces];
    double(*place)[3] = malloc(n * sizeof *place);
    if (!place)
        return false;
    for (size_t c = 0; c < n; c++)
        for (int i = 0; i < 3; i++)
            place[c][i] = cage->position[cage->face_vertex[c]][i];
    qsort(place, n, sizeof *place, compare_places);
    *count = 0;
    for (size_t c = 1; c < n; c++)
        *count += compare_places(place[c - 1], place[c]) == 0;
    free(place);
    return true;
}

static bool find_unwelded(struct inspection *inspection)
{
    struct cage *cage = inspection->cage;
    uint32_t count = 0;
    uint8_t *is_used = calloc(cage->n_vertices + 1, 1);
    bool ok = is_used != NULL;
    if (ok && cage->n_faces > 1 && no_vertex_is_shared(cage, is_used))
        ok = count_repeated_places(cage, &count);
    free(is_used);
    const struct cage_finding finding = {CAGE_FOUND_UNWELDED, count, 0, CAGE_NO_FACE};
    if (ok && count > 0)
        cage_found(cage, &finding, inspection->name,
                   "no face shares a vertex with another, though %u positions are repeated: the "
                   "faces stand apart; --weld joins those of an OBJ file",
                   count);
    return ok;
}

/* --- plain triangles */

static void find_triangles(const struct inspection *inspection)
{
    struct cage *cage = inspection->cage;
    uint32_t count = 0;
    if (!inspection->builder->plain_triangles || cage->scheme != CAGE_SCHEME_CATMULL_CLARK ||
        cage->smooth_triangles)
        return;
    for (size_t f = 0; f < cage->n_faces; f++)
        count += cage->face_start[f + 1] - cage->face_start[f] == 3;
    const struct cage_finding finding = {CAGE_FOUND_TRIANGLES, count, 0, CAGE_NO_FACE};
    cage_found(cage, &finding, inspection->name,
               "plain triangles: Catmull-Clark over triangles, probably not what was modelled; "
               "export quads as OBJ or with FB_ngon_encoding");
}

/* --- faces that repeat another */

struct face_key {
    uint64_t hash;
    uint32_t face;
};

/* The vertices of a face in an order that is the same for equal faces of either direction: from the
 * smallest vertex, towards its smaller neighbour. */
struct walk {
    const uint32_t *vertex;
    uint32_t n, start;
    bool forward;
};

static struct walk walk_of(const struct cage *cage, uint32_t face)
{
    uint32_t first = cage->face_start[face];
    struct walk walk = {&cage->face_vertex[first], cage->face_start[face + 1] - first, 0, true};
    for (uint32_t c = 1; c < walk.n; c++)
        if (walk.vertex[c] < walk.vertex[walk.start])
            walk.start = c;
    walk.forward =
        walk.vertex[(walk.start + 1) % walk.n] < walk.vertex[(walk.start + walk.n - 1) % walk.n];
    return walk;
}

static uint32_t walk_at(const struct walk *walk, uint32_t step)
{
    return walk->vertex[(walk->start + (walk->forward ? step : walk->n - step)) % walk->n];
}

static uint64_t walk_hash(const struct walk *walk, uint64_t seed)
{
    uint64_t hash = seed;
    for (uint32_t c = 0; c < walk->n; c++)
        hash = hash_mix(hash ^ walk_at(walk, c), seed);
    return hash;
}

static bool is_same(const struct cage *cage, uint32_t face, uint32_t other)
{
    struct walk a = walk_of(cage, face), b = walk_of(cage, other);
    if (a.n != b.n)
        return false;
    for (uint32_t c = 0; c < a.n; c++)
        if (walk_at(&a, c) != walk_at(&b, c))
            return false;
    return true;
}

static int compare_keys(const void *a, const void *b)
{
    const struct face_key *p = a, *q = b;
    if (p->hash != q->hash)
        return p->hash < q->hash ? -1 : 1;
    return p->face < q->face ? -1 : p->face > q->face;
}

static void report_repeated(struct inspection *inspection, uint32_t count, uint32_t face,
                            uint32_t earlier)
{
    const struct cage_finding finding = at_face(inspection, CAGE_FOUND_FACE_TWICE, count, face);
    const char *where = finding.line ? "the one of line" : "face";
    uint32_t other = finding.line ? inspection->builder->face_line[earlier] : earlier;
    if (count > 1)
        cage_found(inspection->cage, &finding, inspection->name,
                   "a face repeats %s %u; %u in all, this is the first", where, other, count);
    else if (count == 1)
        cage_found(inspection->cage, &finding, inspection->name, "a face repeats %s %u", where,
                   other);
}

/* Lists the faces that can repeat another: those with a TANGLED edge. (Two faces with the same
 * vertices and opposite directions that are joined to no other face are a pillow, which is a body.)
 * With NULL it only counts. Returns the number. */
static size_t list_keys(const struct inspection *inspection, struct face_key *key)
{
    const struct cage *cage = inspection->cage;
    uint64_t seed = hash_seed();
    size_t n = 0;
    for (uint32_t f = 0; f < cage->n_faces; f++) {
        if (!(inspection->flags[f] & TANGLED))
            continue;
        if (key) {
            struct walk walk = walk_of(cage, f);
            key[n] = (struct face_key){walk_hash(&walk, seed), f};
        }
        n++;
    }
    return n;
}

/* Equal faces have equal hashes, so that after sorting they are adjacent, the earliest first. */
static bool find_repeated(struct inspection *inspection)
{
    size_t n = list_keys(inspection, NULL);
    if (n == 0)
        return true;
    struct face_key *key = malloc(n * sizeof *key);
    if (!key)
        return false;
    list_keys(inspection, key);
    qsort(key, n, sizeof *key, compare_keys);
    uint32_t count = 0, first = UINT32_MAX, original = 0;
    for (size_t i = 1, same = 0; i < n; i++) {
        if (key[i].hash != key[same].hash)
            same = i;
        else if (is_same(inspection->cage, key[i].face, key[same].face)) {
            inspection->flags[key[i].face] |= REPEATED;
            count++;
            if (key[i].face < first) {
                first = key[i].face;
                original = key[same].face;
            }
        }
    }
    free(key);
    if (count > 0)
        report_repeated(inspection, count, first, original);
    return true;
}

/* --- directions of faces that share an edge */

static void mark_edge(void *context, uint32_t low, const struct cage_half_edge *half_edge, size_t n)
{
    struct inspection *inspection = context;
    const uint32_t *face_vertex = inspection->cage->face_vertex;
    (void)low;
    if (n == 1 || (n == 2 && face_vertex[half_edge[0].corner] != face_vertex[half_edge[1].corner]))
        return;
    for (size_t i = 0; i < n; i++)
        inspection->flags[inspection->face_of[half_edge[i].corner]] |= TANGLED;
}

static uint32_t body_of(const struct inspection *inspection, uint32_t face)
{
    uint32_t *body = inspection->body;
    while (body[face] != face)
        face = body[face] = body[body[face]]; /* path halving */
    return face;
}

/* Repeated faces are left out, because their edges would count as traversed in the same
 * direction. */
static void look_at_edge(void *context, uint32_t low, const struct cage_half_edge *half_edge,
                         size_t n)
{
    struct inspection *inspection = context;
    const uint32_t *face_vertex = inspection->cage->face_vertex;
    (void)low;
    size_t n_faces = 0;
    uint32_t face[2] = {0, 0}, from[2] = {0, 0};
    for (size_t i = 0; i < n; i++) {
        uint32_t f = inspection->face_of[half_edge[i].corner];
        if (inspection->flags[f] & REPEATED)
            continue;
        size_t at = n_faces++ ? 1 : 0;
        face[at] = f;
        from[at] = face_vertex[half_edge[i].corner];
        inspection->body[body_of(inspection, f)] = body_of(inspection, face[0]);
    }
    if (n_faces == 0 || (n_faces == 2 && from[0] != from[1]))
        return;
    inspection->flags[face[0]] |= OPEN;
    if (n_faces == 2) {
        inspection->n_against++;
        inspection->against[face[0]]++;
        inspection->against[face[1]]++;
    }
}

static void find_winding(struct inspection *inspection)
{
    struct cage *cage = inspection->cage;
    uint32_t most = 0;
    for (uint32_t f = 0; f < cage->n_faces; f++)
        inspection->body[f] = f;
    cage_each_edge(&inspection->edges, cage->n_vertices, look_at_edge, inspection);
    for (uint32_t f = 1; f < cage->n_faces; f++)
        if (inspection->against[f] > inspection->against[most])
            most = f;
    const struct cage_finding finding =
        at_face(inspection, CAGE_FOUND_WOUND, inspection->n_against, most);
    if (inspection->n_against == 1)
        cage_found(cage, &finding, inspection->name,
                   "a face is wound against its neighbour; the edge between them is a crease");
    else if (inspection->n_against > 1)
        cage_found(cage, &finding, inspection->name,
                   "a face is wound against its neighbours; %u edges in all lie between such "
                   "faces and are creases",
                   inspection->n_against);
}

static bool find_inside_out(struct inspection *inspection)
{
    struct cage *cage = inspection->cage;
    uint32_t count, first = 0;
    for (uint32_t f = 0; f < cage->n_faces; f++) {
        inspection->body[f] = body_of(inspection, f);
        inspection->flags[f] &= REPEATED | OPEN;
    }
    const struct bodies bodies = {cage, inspection->body, inspection->flags};
    if (!bodies_inside_out(&bodies, &count, &first))
        return false;
    const struct cage_finding finding = at_face(inspection, CAGE_FOUND_INSIDE_OUT, count, first);
    if (count == 1)
        cage_found(cage, &finding, inspection->name,
                   "a closed body is inside out: its faces turn inwards, what is convex shows as "
                   "hollow");
    else if (count > 1)
        cage_found(cage, &finding, inspection->name,
                   "a closed body is inside out: its faces turn inwards, what is convex shows as "
                   "hollow; %u bodies in all, this is the first",
                   count);
    return true;
}

/* --- all of them */

static bool inspection_init(struct inspection *inspection)
{
    const struct cage *cage = inspection->cage;
    inspection->face_of = malloc(cage->face_start[cage->n_faces] * sizeof *inspection->face_of);
    inspection->flags = calloc(cage->n_faces, sizeof *inspection->flags);
    inspection->against = calloc(cage->n_faces, sizeof *inspection->against);
    inspection->body = malloc(cage->n_faces * sizeof *inspection->body);
    if (!inspection->face_of || !inspection->flags || !inspection->against || !inspection->body ||
        !cage_edges_init(&inspection->edges, cage))
        return false;
    for (uint32_t f = 0; f < cage->n_faces; f++)
        for (uint32_t c = cage->face_start[f]; c < cage->face_start[f + 1]; c++)
            inspection->face_of[c] = f;
    return true;
}

static void inspection_finish(struct inspection *inspection)
{
    cage_edges_finish(&inspection->edges);
    free(inspection->face_of);
    free(inspection->flags);
    free(inspection->against);
    free(inspection->body);
}

static bool inspect_patches(struct cage *cage, const char *name)
{
    struct cage_joints joints;
    if (!cage_joints_find(&joints, cage))
        return false;
    const struct cage_finding finding = {
        CAGE_FOUND_WOUND, joints.n_against,
        joints.n_against ? cage->patch[joints.first_against].line : 0, CAGE_NO_FACE};
    if (joints.n_against == 1)
        cage_found(cage, &finding, name,
                   "a patch is wound against its neighbour; the edge between them is a border");
    else if (joints.n_against > 1)
        cage_found(cage, &finding, name,
                   "a patch is wound against its neighbours; %u edges in all lie between such "
                   "patches and are borders",
                   joints.n_against);
    cage_joints_finish(&joints);
    return true;
}

static bool inspect_faces(struct inspection *inspection)
{
    find_triangles(inspection);
    if (!find_unwelded(inspection) || !inspection_init(inspection))
        return false;
    cage_each_edge(&inspection->edges, inspection->cage->n_vertices, mark_edge, inspection);
    if (!find_repeated(inspection))
        return false;
    find_winding(inspection);
    return find_inside_out(inspection);
}

void cage_inspect(struct cage_builder *builder, const char *name)
{
    struct inspection inspection = {.cage = &builder->cage, .builder = builder, .name = name};
    bool ok = builder->cage.n_patches > 0 ? inspect_patches(inspection.cage, name)
                                          : inspect_faces(&inspection);
    if (!ok)
        cage_warn(inspection.cage, "%s: not enough memory to look for what is probably not meant",
                  name);
    inspection_finish(&inspection);
}
