/* Cages that can be drawn but probably are not what the modeller meant. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/unit/cage_expect.h"

/* Lines 1 to 8, then a cube's faces in lines 9 to 14. */
#define CORNERS                                                                                    \
    "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
#define CUBE CORNERS "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"
/* A cube's faces over the eight vertices that stand last before the faces. */
#define OUTWARD                                                                                    \
    "f -8 -5 -6 -7\nf -4 -3 -2 -1\nf -8 -7 -3 -4\nf -7 -6 -2 -3\nf -6 -5 -1 -2\nf -5 -8 -4 -1\n"
#define INWARD                                                                                     \
    "f -7 -6 -5 -8\nf -1 -2 -3 -4\nf -4 -3 -7 -8\nf -3 -2 -6 -7\nf -2 -1 -5 -6\nf -1 -4 -8 -5\n"

static const struct cage_finding *find(const struct cage *cage, enum cage_finding_kind kind)
{
    for (size_t i = 0; i < cage->n_findings; i++)
        if (cage->finding[i].kind == kind)
            return &cage->finding[i];
    return NULL;
}

/* Expects this finding and no other, with exactly this text. */
static void expect_one(const char *text, enum cage_finding_kind kind, uint32_t count, uint32_t line,
                       const char *warnings)
{
    struct cage cage;
    read_obj(&cage, text);
    assert_string_equal(cage.warnings ? cage.warnings : "", warnings);
    assert_int_equal(cage.n_findings, 1);
    assert_int_equal(cage.finding[0].kind, kind);
    assert_int_equal(cage.finding[0].count, count);
    assert_int_equal(cage.finding[0].line, line);
    assert_int_equal(cage.finding[0].face, CAGE_NO_FACE);
    cage_finish(&cage);
}

static void expect_none(const char *text)
{
    struct cage cage;
    read_obj(&cage, text);
    assert_string_equal(cage.warnings ? cage.warnings : "", "");
    assert_int_equal(cage.n_findings, 0);
    cage_finish(&cage);
}

static void test_unwelded(void **state)
{
    (void)state;
    /* Two squares, of which each has its own vertices at the common edge. -0 equals 0. */
    expect_one("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 -0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\n"
               "f 1 2 3 4\nf 5 6 7 8\n",
               CAGE_FOUND_UNWELDED, 2, 0,
               "part.obj: no face shares a vertex with another, though 2 positions are repeated: "
               "the faces stand apart; --weld joins those of an OBJ file");
    /* Separate faces without a repeated position; faces that share one vertex; a repeated position
     * that belongs to no face. */
    expect_none("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nv 6 1 0\nv 5 1 0\n"
                "f 1 2 3 4\nf 5 6 7 8\n");
    expect_none("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\n"
                "f 1 2 3 4\nf 2 5 6 7\n");
    expect_none("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 0\nf 1 2 3 4\n");
}

static void test_triangles(void **state)
{
    (void)state;
    static const char warning[] =
        "part.obj: plain triangles: Catmull-Clark over triangles, probably not what was modelled; "
        "export quads as OBJ or with FB_ngon_encoding";
    expect_one(CORNERS "f 1 4 3\nf 1 3 2\nf 5 6 7\n", CAGE_FOUND_TRIANGLES, 3, 0, warning);
    expect_none(CORNERS "f 1 4 3\n");
    expect_none(CORNERS "f 1 4 3\nf 1 3 2\nf 5 6 7 8\n");
    expect_none(CORNERS "f 1 4 3\nf 1 3 2\nt smoothtriangles 0/0/1 smooth\n");
}

static void test_wound(void **state)
{
    (void)state;
    expect_one(CORNERS "f 1 4 3 2\nf 8 7 6 5\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n",
               CAGE_FOUND_WOUND, 4, 10,
               "part.obj:10: a face is wound against its neighbours; 4 edges in all lie between "
               "such faces and are creases");
    expect_one(CORNERS "f 1 2 6 5\nf 3 2 6 7\n", CAGE_FOUND_WOUND, 1, 9,
               "part.obj:9: a face is wound against its neighbour; the edge between them is a "
               "crease");
    /* The three faces at one edge cannot all have opposite directions, so no winding is
     * reported. */
    expect_none(CORNERS "f 1 2 6 5\nf 3 2 6 7\nf 4 2 6 8\n");
}

static void test_twice(void **state)
{
    (void)state;
    expect_one(CUBE "f 6 7 8 5\n", CAGE_FOUND_FACE_TWICE, 1, 15,
               "part.obj:15: a face repeats the one of line 10");
    expect_one(CUBE "f 6 7 8 5\nf 8 7 6 5\nf 1 2 6 5\n", CAGE_FOUND_FACE_TWICE, 3, 15,
               "part.obj:15: a face repeats the one of line 10; 3 in all, this is the first");
    /* A face with the same vertices in another cyclic order is another face. */
    struct cage cage;
    read_obj(&cage, CUBE "f 5 7 6 8\n");
    assert_null(find(&cage, CAGE_FOUND_FACE_TWICE));
    cage_finish(&cage);
    /* Two faces back to back make a closed body. In an open sheet whose faces exist twice, both
     * repetitions are reported. */
    expect_none(CORNERS "f 1 2 3 4\nf 4 3 2 1\n");
    read_obj(&cage, CORNERS "f 1 2 6 5\nf 2 3 7 6\nf 5 6 2 1\nf 6 7 3 2\n");
    assert_int_equal(find(&cage, CAGE_FOUND_FACE_TWICE)->count, 2);
    cage_finish(&cage);
}

#define SMALL                                                                                      \
    "v -.5 -.5 -.5\nv .5 -.5 -.5\nv .5 .5 -.5\nv -.5 .5 -.5\nv -.5 -.5 .5\nv .5 -.5 .5\n"          \
    "v .5 .5 .5\nv -.5 .5 .5\n"
#define BESIDE                                                                                     \
    "v 9 -1 -1\nv 11 -1 -1\nv 11 1 -1\nv 9 1 -1\nv 9 -1 1\nv 11 -1 1\nv 11 1 1\nv 9 1 1\n"
#define FAR                                                                                        \
    "v 1e9 0 0\nv 1000000001 0 0\nv 1000000001 1 0\nv 1e9 1 0\nv 1e9 0 1\nv 1000000001 0 1\n"      \
    "v 1000000001 1 1\nv 1e9 1 1\n"

static void test_inside_out(void **state)
{
    (void)state;
    static const char one[] = "a closed body is inside out: its faces turn inwards, what is convex "
                              "shows as hollow";
    char text[300];
    snprintf(text, sizeof text, "part.obj:9: %s", one);
    expect_one(CORNERS INWARD, CAGE_FOUND_INSIDE_OUT, 1, 9, text);
    expect_one(FAR INWARD, CAGE_FOUND_INSIDE_OUT, 1, 9, text);
    snprintf(text, sizeof text, "part.obj:23: %s", one);
    expect_one(CUBE BESIDE INWARD, CAGE_FOUND_INSIDE_OUT, 1, 23, text);
    snprintf(text, sizeof text, "part.obj:9: %s; 2 bodies in all, this is the first", one);
    expect_one(CORNERS INWARD BESIDE INWARD SMALL OUTWARD, CAGE_FOUND_INSIDE_OUT, 2, 9, text);
    /* A hollow inside a body; a body that is open; a flat closed body. */
    expect_none(CORNERS OUTWARD SMALL INWARD);
    expect_none(CORNERS "f 2 3 4 1\nf 5 6 2 1\nf 6 7 3 2\nf 7 8 4 3\nf 8 5 1 4\n");
    expect_none(CORNERS "f 1 2 3 4\nf 4 3 2 1\n");
}

/* --- random cages made of cubes, against counts by comparison of all pairs */

enum { SIDE = 4, POINTS = (SIDE + 1) * (SIDE + 1) * (SIDE + 1), MOST_FACES = 600 };

struct block {
    int n_faces;
    uint32_t vertex[MOST_FACES][4];
};

struct judged {
    bool again[MOST_FACES];
    uint32_t n_again, first_again;
    uint32_t n_wound, most_wound;
    uint32_t n_inside_out, first_inside_out;
};

static uint32_t below(uint32_t *random, uint32_t n)
{
    *random = *random * 1664525 + 1013904223;
    return (*random >> 8) % n;
}

static uint32_t point(const int at[3])
{
    return (uint32_t)(at[0] + (SIDE + 1) * (at[1] + (SIDE + 1) * at[2]));
}

static bool is_filled(const bool *cell, const int at[3])
{
    for (int i = 0; i < 3; i++)
        if (at[i] < 0 || at[i] >= SIDE)
            return false;
    return cell[at[0] + SIDE * (at[1] + SIDE * at[2])];
}

/* The face of a cell on one side of one axis, wound outwards. */
static void add_face(struct block *block, const int cell[3], int axis, int side)
{
    uint32_t *vertex = block->vertex[block->n_faces++];
    for (int c = 0; c < 4; c++) {
        int at[3] = {cell[0], cell[1], cell[2]};
        int corner = side ? c : 3 - c;
        at[axis] += side;
        at[(axis + 1) % 3] += corner == 1 || corner == 2;
        at[(axis + 2) % 3] += corner == 2 || corner == 3;
        vertex[c] = point(at);
    }
}

static void turn(uint32_t *vertex)
{
    uint32_t second = vertex[1];
    vertex[1] = vertex[3];
    vertex[3] = second;
}

static bool share_edge(const uint32_t *a, const uint32_t *b)
{
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            if ((a[i] == b[j] && a[(i + 1) % 4] == b[(j + 1) % 4]) ||
                (a[i] == b[(j + 1) % 4] && a[(i + 1) % 4] == b[j]))
                return true;
    return false;
}

/* Gives faces that share an edge the same body number, until nothing changes. */
static void find_bodies(const struct block *block, const bool *left_out, int *body)
{
    for (int f = 0; f < block->n_faces; f++)
        body[f] = f;
    for (bool changed = true; changed;) {
        changed = false;
        for (int f = 0; f < block->n_faces; f++)
            for (int g = 0; g < f; g++) {
                if (body[f] == body[g] || left_out[f] || left_out[g] ||
                    !share_edge(block->vertex[f], block->vertex[g]))
                    continue;
                body[f] = body[g] = body[f] < body[g] ? body[f] : body[g];
                changed = true;
            }
    }
}

static void make_block(struct block *block, uint32_t *random)
{
    bool cell[SIDE * SIDE * SIDE];
    uint32_t density = 1 + below(random, 9);
    *block = (struct block){0};
    for (int i = 0; i < SIDE * SIDE * SIDE; i++)
        cell[i] = below(random, 10) < density;
    for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
        const int at[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
        for (int axis = 0; cell[i] && axis < 3; axis++)
            for (int side = 0; side < 2; side++) {
                int beside[3] = {at[0], at[1], at[2]};
                beside[axis] += side ? 1 : -1;
                if (!is_filled(cell, beside))
                    add_face(block, at, axis, side);
            }
    }
}

/* Inverts bodies and faces, repeats some faces in either direction and from any first corner, and
 * removes one face. */
static void damage(struct block *block, uint32_t *random)
{
    static const bool none[MOST_FACES] = {0};
    static int body[MOST_FACES];
    find_bodies(block, none, body);
    for (int f = 0; f < block->n_faces; f++)
        if (body[f] == f && below(random, 2))
            for (int g = 0; g < block->n_faces; g++)
                if (body[g] == f)
                    turn(block->vertex[g]);
    for (uint32_t i = below(random, 3); i > 0 && block->n_faces; i--)
        turn(block->vertex[below(random, (uint32_t)block->n_faces)]);
    for (uint32_t i = below(random, 4); i > 0 && block->n_faces; i--) {
        const uint32_t *vertex = block->vertex[below(random, (uint32_t)block->n_faces)];
        uint32_t begin = below(random, 4);
        for (uint32_t c = 0; c < 4; c++)
            block->vertex[block->n_faces][c] = vertex[(begin + c) % 4];
        if (below(random, 2))
            turn(block->vertex[block->n_faces]);
        block->n_faces++;
    }
    if (below(random, 4) == 0 && block->n_faces > 1)
        block->n_faces--;
}

/* Returns 1 if ring b is ring a in the same direction, -1 if in the opposite direction, else 0. */
static int same_ring(const uint32_t *a, const uint32_t *b)
{
    for (int way = -1; way < 2; way += 2)
        for (int begin = 0; begin < 4; begin++) {
            int same = 0;
            for (int c = 0; c < 4; c++)
                same += a[c] == b[(begin + way * c + 4) % 4];
            if (same == 4)
                return way;
        }
    return 0;
}

/* The faces that run along an edge of the block, and how many of them run from a to b. */
static int faces_along(const struct block *block, const bool *left_out, uint32_t a, uint32_t b,
                       int *forward)
{
    int n = 0;
    *forward = 0;
    for (int f = 0; f < block->n_faces; f++)
        for (int c = 0; c < 4 && !(left_out && left_out[f]); c++) {
            uint32_t p = block->vertex[f][c], q = block->vertex[f][(c + 1) % 4];
            *forward += p == a && q == b;
            n += (p == a && q == b) || (p == b && q == a);
        }
    return n;
}

static void judge_twice(const struct block *block, struct judged *judged)
{
    for (int f = 0; f < block->n_faces; f++) {
        int way = 0, forward;
        for (int g = 0; g < f && !way; g++)
            way = same_ring(block->vertex[f], block->vertex[g]);
        bool many = false;
        for (int c = 0; c < 4; c++)
            many |= faces_along(block, NULL, block->vertex[f][c], block->vertex[f][(c + 1) % 4],
                                &forward) > 2;
        /* A repeated face in the opposite direction counts as a repetition if an edge has more than
         * two faces. The first of the equal faces may have been inverted itself, but its edges are
         * the same. */
        judged->again[f] = way == 1 || (way == -1 && many);
        if (judged->again[f] && judged->n_again++ == 0)
            judged->first_again = (uint32_t)f;
    }
}

static void judge_winding(const struct block *block, struct judged *judged, bool *is_open)
{
    uint32_t most = 0;
    for (int f = 0; f < block->n_faces; f++) {
        uint32_t against = 0;
        for (int c = 0; c < 4 && !judged->again[f]; c++) {
            int forward;
            int n = faces_along(block, judged->again, block->vertex[f][c],
                                block->vertex[f][(c + 1) % 4], &forward);
            against += n == 2 && forward == 2;
            is_open[f] |= n != 2 || forward != 1;
        }
        judged->n_wound += against;
        if (against > most) {
            most = against;
            judged->most_wound = (uint32_t)f;
        }
    }
    judged->n_wound /= 2;
}

struct box {
    int low[3], high[3];
    int volume; /* the signed volume, by the faces perpendicular to x */
    bool is_open;
};

static struct box box_of(const struct block *block, const int *body, const bool *is_open, int which)
{
    struct box box = {{SIDE, SIDE, SIDE}, {0, 0, 0}, 0, false};
    for (int f = 0; f < block->n_faces; f++) {
        if (body[f] != which)
            continue;
        int at[4][3];
        box.is_open |= is_open[f];
        for (int c = 0; c < 4; c++) {
            int v = (int)block->vertex[f][c];
            const int place[3] = {v % (SIDE + 1), v / (SIDE + 1) % (SIDE + 1),
                                  v / (SIDE + 1) / (SIDE + 1)};
            for (int i = 0; i < 3; i++) {
                at[c][i] = place[i];
                box.low[i] = place[i] < box.low[i] ? place[i] : box.low[i];
                box.high[i] = place[i] > box.high[i] ? place[i] : box.high[i];
            }
        }
        int across = (at[1][1] - at[0][1]) * (at[2][2] - at[1][2]) -
                     (at[1][2] - at[0][2]) * (at[2][1] - at[1][1]);
        box.volume += at[0][0] * across; /* 0 for faces along x */
    }
    return box;
}

static bool is_inside(const struct box *a, const struct box *b)
{
    bool inside = true;
    for (int i = 0; i < 3; i++)
        inside &= b->low[i] < a->low[i] && a->high[i] < b->high[i];
    return inside;
}

static void judge_bodies(const struct block *block, struct judged *judged, const bool *is_open)
{
    static int body[MOST_FACES];
    find_bodies(block, judged->again, body);
    for (int f = 0; f < block->n_faces; f++) {
        if (body[f] != f || judged->again[f])
            continue;
        struct box box = box_of(block, body, is_open, f);
        bool counts = !box.is_open && box.volume < 0;
        for (int g = 0; counts && g < block->n_faces; g++) {
            struct box other = {0};
            if (body[g] == g && !judged->again[g])
                other = box_of(block, body, is_open, g);
            counts = other.is_open || other.volume <= 0 || !is_inside(&box, &other);
        }
        if (counts && judged->n_inside_out++ == 0)
            judged->first_inside_out = (uint32_t)f;
    }
}

static void read_block(struct cage *cage, const struct block *block)
{
    static char text[POINTS * 20 + MOST_FACES * 24];
    size_t used = 0;
    for (int v = 0; v < POINTS; v++)
        used += (size_t)snprintf(text + used, sizeof text - used, "v %d %d %d\n", v % (SIDE + 1),
                                 v / (SIDE + 1) % (SIDE + 1), v / (SIDE + 1) / (SIDE + 1));
    for (int f = 0; f < block->n_faces; f++) {
        const uint32_t *vertex = block->vertex[f];
        used += (size_t)snprintf(text + used, sizeof text - used, "f %u %u %u %u\n", vertex[0] + 1,
                                 vertex[1] + 1, vertex[2] + 1, vertex[3] + 1);
    }
    read_obj(cage, text);
}

static void expect_count(const struct cage *cage, enum cage_finding_kind kind, uint32_t count,
                         uint32_t face, uint32_t *total)
{
    const struct cage_finding *finding = find(cage, kind);
    assert_int_equal(finding ? finding->count : 0, count);
    if (finding)
        assert_int_equal(finding->line, POINTS + 1 + face);
    *total += count;
}

static void test_random(void **state)
{
    (void)state;
    uint32_t random = 7, twice = 0, wound = 0, inside_out = 0;
    for (int round = 0; round < 300; round++) {
        static struct block block;
        bool is_open[MOST_FACES] = {0};
        struct judged judged = {0};
        struct cage cage;
        make_block(&block, &random);
        damage(&block, &random);
        if (block.n_faces == 0)
            continue;
        judge_twice(&block, &judged);
        judge_winding(&block, &judged, is_open);
        judge_bodies(&block, &judged, is_open);
        read_block(&cage, &block);
        expect_count(&cage, CAGE_FOUND_FACE_TWICE, judged.n_again, judged.first_again, &twice);
        expect_count(&cage, CAGE_FOUND_WOUND, judged.n_wound, judged.most_wound, &wound);
        expect_count(&cage, CAGE_FOUND_INSIDE_OUT, judged.n_inside_out, judged.first_inside_out,
                     &inside_out);
        cage_finish(&cage);
    }
    print_message("%u faces twice, %u edges wound alike, %u bodies inside out\n", twice, wound,
                  inside_out);
    assert_true(twice > 200 && wound > 200 && inside_out > 50);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_unwelded),   cmocka_unit_test(test_triangles),
        cmocka_unit_test(test_wound),      cmocka_unit_test(test_twice),
        cmocka_unit_test(test_inside_out), cmocka_unit_test(test_random),
    };
    return cmocka_run_group_tests_name("cage/inspect", tests, NULL, NULL);
}
