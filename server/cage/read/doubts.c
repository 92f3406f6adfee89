#include "server/cage/read/doubts.h"

#include <stdlib.h>

#include "server/cage/hash.h"
#include "server/cage/read/bodies.h"
#include "server/cage/sides.h"

enum {
    TANGLED = 1, /* on an edge of more than two faces, or of two that run along it alike */
    AGAIN = 2,   /* repeats an earlier face */
    OPEN = 4,    /* on an edge that a closed body has not */
};

struct doubts {
    struct cage *cage;
    const struct cage_builder *builder;
    const char *name;
    struct cage_sides sides;
    uint32_t *face_of; /* [corners] */
    uint8_t *flags;    /* [n_faces] */
    uint32_t *against; /* [n_faces]: its edges that a neighbour runs along in the same direction */
    uint32_t *body;    /* [n_faces]: union-find of the faces that edges join */
    uint32_t n_against;
};

static struct cage_finding at_face(const struct doubts *doubts, enum cage_finding_kind kind,
                                   uint32_t count, uint32_t face)
{
    uint32_t line = doubts->builder->face_line[face];
    return (struct cage_finding){kind, count, line, line ? CAGE_NO_FACE : face};
}

/* --- faces that stand apart */

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

/* How many corners stand where another does that sorts before them. False: no memory. */
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

static bool doubt_unwelded(struct doubts *doubts)
{
    struct cage *cage = doubts->cage;
    uint32_t count = 0;
    uint8_t *is_used = calloc(cage->n_vertices + 1, 1);
    bool ok = is_used != NULL;
    if (ok && cage->n_faces > 1 && no_vertex_is_shared(cage, is_used))
        ok = count_repeated_places(cage, &count);
    free(is_used);
    const struct cage_finding finding = {CAGE_FOUND_UNWELDED, count, 0, CAGE_NO_FACE};
    if (ok && count > 0)
        cage_found(cage, &finding, doubts->name,
                   "no face shares a vertex with another, though %u positions are repeated: the "
                   "faces stand apart; --weld joins those of an OBJ file",
                   count);
    return ok;
}

/* --- plain triangles */

static void doubt_triangles(const struct doubts *doubts)
{
    struct cage *cage = doubts->cage;
    uint32_t count = 0;
    if (!doubts->builder->plain_triangles || cage->scheme != CAGE_SCHEME_CATMULL_CLARK ||
        cage->smooth_triangles)
        return;
    for (size_t f = 0; f < cage->n_faces; f++)
        count += cage->face_start[f + 1] - cage->face_start[f] == 3;
    const struct cage_finding finding = {CAGE_FOUND_TRIANGLES, count, 0, CAGE_NO_FACE};
    cage_found(cage, &finding, doubts->name,
               "plain triangles: Catmull-Clark over triangles, probably not what was modelled; "
               "export quads as OBJ or with FB_ngon_encoding");
}

/* --- faces that are there twice */

struct ring {
    uint64_t hash;
    uint32_t face;
};

/* A face's vertices from the smallest on, towards its smaller neighbour. */
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

static int compare_rings(const void *a, const void *b)
{
    const struct ring *p = a, *q = b;
    if (p->hash != q->hash)
        return p->hash < q->hash ? -1 : 1;
    return p->face < q->face ? -1 : p->face > q->face;
}

static void report_twice(struct doubts *doubts, uint32_t count, uint32_t face, uint32_t earlier)
{
    const struct cage_finding finding = at_face(doubts, CAGE_FOUND_FACE_TWICE, count, face);
    const char *where = finding.line ? "the one of line" : "face";
    uint32_t other = finding.line ? doubts->builder->face_line[earlier] : earlier;
    if (count > 1)
        cage_found(doubts->cage, &finding, doubts->name,
                   "a face repeats %s %u; %u in all, this is the first", where, other, count);
    else if (count == 1)
        cage_found(doubts->cage, &finding, doubts->name, "a face repeats %s %u", where, other);
}

/* Those that can be the same as another: its edges are tangled, unless the two are all there is and
 * turned against each other, which is a pillow. Returns how many there are. */
static size_t fill_rings(const struct doubts *doubts, struct ring *ring)
{
    const struct cage *cage = doubts->cage;
    uint64_t seed = hash_seed();
    size_t n = 0;
    for (uint32_t f = 0; f < cage->n_faces; f++) {
        if (!(doubts->flags[f] & TANGLED))
            continue;
        if (ring) {
            struct walk walk = walk_of(cage, f);
            ring[n] = (struct ring){walk_hash(&walk, seed), f};
        }
        n++;
    }
    return n;
}

/* Equal faces have equal hashes and stand together, the earliest first, once they are sorted. */
static bool doubt_twice(struct doubts *doubts)
{
    size_t n = fill_rings(doubts, NULL);
    if (n == 0)
        return true;
    struct ring *ring = malloc(n * sizeof *ring);
    if (!ring)
        return false;
    fill_rings(doubts, ring);
    qsort(ring, n, sizeof *ring, compare_rings);
    uint32_t count = 0, first = UINT32_MAX, original = 0;
    for (size_t i = 1, same = 0; i < n; i++) {
        if (ring[i].hash != ring[same].hash)
            same = i;
        else if (is_same(doubts->cage, ring[i].face, ring[same].face)) {
            doubts->flags[ring[i].face] |= AGAIN;
            count++;
            if (ring[i].face < first) {
                first = ring[i].face;
                original = ring[same].face;
            }
        }
    }
    free(ring);
    if (count > 0)
        report_twice(doubts, count, first, original);
    return true;
}

/* --- how faces that share an edge are wound */

static void mark_edge(void *context, uint32_t low, const struct cage_side *side, size_t n)
{
    struct doubts *doubts = context;
    const uint32_t *face_vertex = doubts->cage->face_vertex;
    (void)low;
    if (n == 1 || (n == 2 && face_vertex[side[0].corner] != face_vertex[side[1].corner]))
        return;
    for (size_t i = 0; i < n; i++)
        doubts->flags[doubts->face_of[side[i].corner]] |= TANGLED;
}

static uint32_t body_of(const struct doubts *doubts, uint32_t face)
{
    uint32_t *body = doubts->body;
    while (body[face] != face)
        face = body[face] = body[body[face]]; /* halves the path */
    return face;
}

/* Faces that repeat another are left out: they would be wound like it. */
static void look_at_edge(void *context, uint32_t low, const struct cage_side *side, size_t n)
{
    struct doubts *doubts = context;
    const uint32_t *face_vertex = doubts->cage->face_vertex;
    (void)low;
    size_t n_faces = 0;
    uint32_t face[2] = {0, 0}, from[2] = {0, 0};
    for (size_t i = 0; i < n; i++) {
        uint32_t f = doubts->face_of[side[i].corner];
        if (doubts->flags[f] & AGAIN)
            continue;
        size_t at = n_faces++ ? 1 : 0;
        face[at] = f;
        from[at] = face_vertex[side[i].corner];
        doubts->body[body_of(doubts, f)] = body_of(doubts, face[0]);
    }
    if (n_faces == 0 || (n_faces == 2 && from[0] != from[1]))
        return;
    doubts->flags[face[0]] |= OPEN;
    if (n_faces == 2) {
        doubts->n_against++;
        doubts->against[face[0]]++;
        doubts->against[face[1]]++;
    }
}

static void doubt_winding(struct doubts *doubts)
{
    struct cage *cage = doubts->cage;
    uint32_t most = 0;
    for (uint32_t f = 0; f < cage->n_faces; f++)
        doubts->body[f] = f;
    cage_each_edge(&doubts->sides, cage->n_vertices, look_at_edge, doubts);
    for (uint32_t f = 1; f < cage->n_faces; f++)
        if (doubts->against[f] > doubts->against[most])
            most = f;
    const struct cage_finding finding = at_face(doubts, CAGE_FOUND_WOUND, doubts->n_against, most);
    if (doubts->n_against == 1)
        cage_found(cage, &finding, doubts->name,
                   "a face is wound against its neighbour; the edge between them is a crease");
    else if (doubts->n_against > 1)
        cage_found(cage, &finding, doubts->name,
                   "a face is wound against its neighbours; %u edges in all lie between such "
                   "faces and are creases",
                   doubts->n_against);
}

static bool doubt_inside_out(struct doubts *doubts)
{
    struct cage *cage = doubts->cage;
    uint32_t count, first = 0;
    for (uint32_t f = 0; f < cage->n_faces; f++) {
        doubts->body[f] = body_of(doubts, f);
        doubts->flags[f] &= AGAIN | OPEN;
    }
    const struct bodies bodies = {cage, doubts->body, doubts->flags};
    if (!bodies_inside_out(&bodies, &count, &first))
        return false;
    const struct cage_finding finding = at_face(doubts, CAGE_FOUND_INSIDE_OUT, count, first);
    if (count == 1)
        cage_found(cage, &finding, doubts->name,
                   "a closed body is inside out: its faces turn inwards, what is convex shows as "
                   "hollow");
    else if (count > 1)
        cage_found(cage, &finding, doubts->name,
                   "a closed body is inside out: its faces turn inwards, what is convex shows as "
                   "hollow; %u bodies in all, this is the first",
                   count);
    return true;
}

/* --- all of them */

static bool doubts_init(struct doubts *doubts)
{
    const struct cage *cage = doubts->cage;
    doubts->face_of = malloc(cage->face_start[cage->n_faces] * sizeof *doubts->face_of);
    doubts->flags = calloc(cage->n_faces, sizeof *doubts->flags);
    doubts->against = calloc(cage->n_faces, sizeof *doubts->against);
    doubts->body = malloc(cage->n_faces * sizeof *doubts->body);
    if (!doubts->face_of || !doubts->flags || !doubts->against || !doubts->body ||
        !cage_sides_init(&doubts->sides, cage))
        return false;
    for (uint32_t f = 0; f < cage->n_faces; f++)
        for (uint32_t c = cage->face_start[f]; c < cage->face_start[f + 1]; c++)
            doubts->face_of[c] = f;
    return true;
}

static void doubts_finish(struct doubts *doubts)
{
    cage_sides_finish(&doubts->sides);
    free(doubts->face_of);
    free(doubts->flags);
    free(doubts->against);
    free(doubts->body);
}

void cage_doubt(struct cage_builder *builder, const char *name)
{
    struct doubts doubts = {.cage = &builder->cage, .builder = builder, .name = name};
    doubt_triangles(&doubts);
    bool ok = doubt_unwelded(&doubts) && doubts_init(&doubts);
    if (ok) {
        cage_each_edge(&doubts.sides, doubts.cage->n_vertices, mark_edge, &doubts);
        ok = doubt_twice(&doubts);
    }
    if (ok) {
        doubt_winding(&doubts);
        ok = doubt_inside_out(&doubts);
    }
    if (!ok)
        cage_warn(doubts.cage, "%s: not enough memory to look for what is probably not meant",
                  name);
    doubts_finish(&doubts);
}
