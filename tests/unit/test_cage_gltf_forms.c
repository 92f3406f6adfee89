/* The forms that glTF 2.0 allows for vertices and triangles, besides indexed triangles of
 * floats. */
#include "server/cage/read/read.h"
#include "tests/unit/gltf_sample.h"

#include <math.h>

#define GRID_ACCESSOR "{\"bufferView\":0,\"componentType\":5126,\"type\":\"VEC3\",\"count\":6}"
#define PAIR_ACCESSOR "{\"bufferView\":1,\"componentType\":5123,\"type\":\"SCALAR\",\"count\":12}"

/* A generator of pseudo-random numbers with a fixed seed, so that each run tests the same. */
static uint32_t random_state;

static uint32_t next_random(uint32_t below)
{
    random_state = random_state * 1664525u + 1013904223u;
    return (uint32_t)(((uint64_t)random_state * below) >> 32);
}

/* Strips and fans */

static double signed_area(const struct cage *cage, size_t face)
{
    const uint32_t *v = &cage->face_vertex[cage->face_start[face]];
    const double *a = cage->position[v[0]], *b = cage->position[v[1]], *c = cage->position[v[2]];
    return ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
}

/* A band along x and a disc around vertex 0, both counter-clockwise. The sign of each triangle's
 * area tells its winding; the sum of the areas tells whether a triangle is missing or repeated. */
static void test_strips_and_fans(void **state)
{
    (void)state;
    float band[11][3], disc[11][3] = {{0}};
    for (int i = 0; i < 11; i++) {
        band[i][0] = (float)(i / 2);
        band[i][1] = (float)(1 - i % 2);
        band[i][2] = (float)i;
        disc[i][0] = i ? cosf((float)i / 2) : 0;
        disc[i][1] = i ? sinf((float)i / 2) : 0;
        disc[i][2] = (float)i;
    }
    static const uint16_t order[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
    for (size_t n = 3; n <= 11; n++) {
        struct cage cage;
        double strip = 0, fan = 0;
        read_good(&cage, &(struct sample){.positions = band[0],
                                          .n_positions = 11,
                                          .indices = order,
                                          .n_indices = n,
                                          .primitive = "\"mode\":5"});
        assert_int_equal(cage.n_faces, n - 2);
        for (size_t f = 0; f < n - 2; f++) {
            assert_true(signed_area(&cage, f) == 0.5);
            strip += signed_area(&cage, f);
        }
        assert_true(strip == (double)(n - 2) / 2);
        EXPECT_FACE(&cage, 0, 0, 1, 2);
        if (n > 3)
            EXPECT_FACE(&cage, 1, 1, 3, 2);
        cage_finish(&cage);
        read_good(&cage, &(struct sample){.positions = disc[0],
                                          .n_positions = 11,
                                          .indices = order,
                                          .n_indices = n,
                                          .primitive = "\"mode\":6"});
        assert_int_equal(cage.n_faces, n - 2);
        for (size_t f = 0; f < n - 2; f++)
            fan += signed_area(&cage, f);
        assert_true(fabs(fan - (double)(n - 2) * sin(0.5) / 2) < 1e-6);
        EXPECT_FACE(&cage, 0, 1, 2, 0);
        cage_finish(&cage);
    }
}

/* Repeated vertices join two strips. The degenerate triangles at the joint are no faces. */
static void test_strip_joints(void **state)
{
    (void)state;
    static const uint16_t joined[] = {3, 0, 4, 1, 1, 2, 2, 5, 4};
    struct cage cage;
    read_good(&cage,
              &(struct sample){.indices = joined, .n_indices = 9, .primitive = "\"mode\":5"});
    assert_int_equal(cage.n_faces, 3);
    EXPECT_FACE(&cage, 0, 3, 0, 4);
    EXPECT_FACE(&cage, 1, 0, 1, 4);
    EXPECT_FACE(&cage, 2, 2, 5, 4);
    cage_finish(&cage);
    /* FB_ngon_encoding applies to separate triangles only, so each triangle of a fan is a face. */
    static const uint16_t fan[] = {0, 1, 4, 3};
    read_good(&cage, &(struct sample){.indices = fan,
                                      .n_indices = 4,
                                      .primitive = "\"mode\":6,\"extensions\":{"
                                                   "\"FB_ngon_encoding\":{}}"});
    assert_int_equal(cage.n_faces, 2);
    cage_finish(&cage);
    static const uint16_t restart[] = {0, 1, 4, 3, 0xffff, 1, 2, 5};
    expect_bad(&(struct sample){.indices = restart, .n_indices = 8, .primitive = "\"mode\":5"},
               "part.glb: mesh 0 primitive 0: index 4 is 65535, which restarts a primitive "
               "elsewhere; glTF does not allow it");
    expect_bad(&(struct sample){.indices = restart, .n_indices = 2, .primitive = "\"mode\":5"},
               "part.glb: mesh 0 primitive 0: 2 indices do not make whole triangles");
    expect_bad(&(struct sample){.indices = restart, .n_indices = 1, .primitive = "\"mode\":6"},
               "part.glb: mesh 0 primitive 0: 1 indices do not make whole triangles");
}

/* Quantized positions */

static void test_quantized(void **state)
{
    (void)state;
    static const struct {
        int component;
        bool normalized;
        /* of one vertex: three integers of 8 bits and a byte of padding, or three of 16 bits */
        uint16_t bits[6];
        double x, y, z;
    } forms[] = {
        {5120, false, {0x7f80, 0x0001}, -128, 127, 1},
        {5120, true, {0x7f80, 0x0001}, -1, 1, 1 / 127.0},
        {5121, false, {0xff80, 0x0001}, 128, 255, 1},
        {5121, true, {0xff80, 0x0001}, 128 / 255.0, 1, 1 / 255.0},
        {5122, false, {0x8000, 0x7fff, 5}, -32768, 32767, 5},
        {5122, true, {0x8000, 0x7fff, 5}, -1, 1, 5 / 32767.0},
        {5123, false, {0x8000, 0xffff, 5}, 32768, 65535, 5},
        {5123, true, {0x8000, 0xffff, 5}, 32768 / 65535.0, 1, 5 / 65535.0},
    };
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
        bool narrow = forms[i].component < 5122;
        size_t stride = narrow ? 2 : 4; /* distance of two vertices, in elements of bits[] */
        uint16_t bits[12] = {0};
        for (size_t v = 0; v < 3; v++)
            memcpy(&bits[v * stride], forms[i].bits, stride * sizeof *bits);
        bits[stride] ^= 0x0101; /* makes the vertices differ, so that they make a face */
        bits[2 * stride] ^= 0x0202;
        char accessors[200], views[200];
        snprintf(accessors, sizeof accessors,
                 "{\"bufferView\":0,\"componentType\":%d,\"normalized\":%s,\"type\":\"VEC3\","
                 "\"count\":3}",
                 forms[i].component, forms[i].normalized ? "true" : "false");
        snprintf(views, sizeof views,
                 "{\"buffer\":0,\"byteOffset\":72,\"byteLength\":%zu,\"byteStride\":%zu}",
                 3 * stride * 2, stride * 2);
        struct cage cage;
        read_good(&cage, &(struct sample){
                             .top = "\"extensionsRequired\":[\"KHR_mesh_quantization\"],",
                             .indices = bits,
                             .n_indices = 12,
                             .accessors = accessors,
                             .views = views,
                             .meshes = "{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}"});
        expect_position(&cage, 0, forms[i].x, forms[i].y, forms[i].z);
        cage_finish(&cage);
    }
}

/* A sparse accessor gives the same cage as a file in which the replaced elements are written
 * out. */

static void compare_with_dense(unsigned trial)
{
    enum { N = 40, MOST = 12 };
    random_state = trial;
    float base[N + MOST][3], dense[N][3];
    uint16_t indices[3 * N + MOST], replaced[3 * N];
    for (int v = 0; v < N + MOST; v++)
        for (int i = 0; i < 3; i++)
            base[v][i] = (float)next_random(1000000);
    for (int i = 0; i < 3 * N; i++)
        indices[i] = (uint16_t)next_random(N);
    size_t count = 3 + next_random(MOST - 2), first = next_random(4);
    bool has_base = next_random(2);
    memcpy(dense, base, sizeof dense);
    if (!has_base)
        memset(dense, 0, sizeof dense);
    for (size_t s = 0; s < count; s++) {
        uint16_t element = (uint16_t)(first + s * (1 + trial % 3));
        indices[3 * N + s] = element;
        memcpy(dense[element], base[N + s], sizeof *dense);
    }
    memcpy(indices, &indices[3 * N], 3 * sizeof *indices); /* at least one face */
    memcpy(replaced, indices, sizeof replaced);
    char views[300], accessors[500];
    snprintf(views, sizeof views,
             "{\"buffer\":0,\"byteLength\":%d},{\"buffer\":0,\"byteOffset\":%d,\"byteLength\":%d}",
             (N + MOST) * 12, (N + MOST) * 12, (3 * N + MOST) * 2);
    snprintf(accessors, sizeof accessors,
             "{%s\"componentType\":5126,\"type\":\"VEC3\",\"count\":%d,\"sparse\":{\"count\":%zu,"
             "\"indices\":{\"bufferView\":1,\"byteOffset\":%d,\"componentType\":5123},"
             "\"values\":{\"bufferView\":0,\"byteOffset\":%d}}},"
             "{\"bufferView\":1,\"componentType\":5123,\"type\":\"SCALAR\",\"count\":%d}",
             has_base ? "\"bufferView\":0," : "", N, count, 3 * N * 2, N * 12, 3 * N);
    struct cage sparse, written_out;
    read_good(&sparse, &(struct sample){.positions = base[0],
                                        .n_positions = N + MOST,
                                        .indices = indices,
                                        .n_indices = 3 * N + MOST,
                                        .views = views,
                                        .accessors = accessors});
    read_good(&written_out, &(struct sample){.positions = dense[0],
                                             .n_positions = N,
                                             .indices = replaced,
                                             .n_indices = 3 * N});
    assert_int_equal(sparse.n_vertices, written_out.n_vertices);
    assert_int_equal(sparse.n_faces, written_out.n_faces);
    assert_memory_equal(sparse.position, written_out.position,
                        sparse.n_vertices * sizeof *sparse.position);
    assert_memory_equal(sparse.face_vertex, written_out.face_vertex,
                        sparse.face_start[sparse.n_faces] * sizeof *sparse.face_vertex);
    cage_finish(&sparse);
    cage_finish(&written_out);
}

static void test_sparse(void **state)
{
    (void)state;
    for (unsigned trial = 0; trial < 200; trial++)
        compare_with_dense(trial);
    /* Indices may be sparse, too: the last index of PAIR becomes 3. */
    struct cage cage;
    read_good(&cage, &(struct sample){
                         .accessors =
                             GRID_ACCESSOR ",{\"bufferView\":1,\"componentType\":5123,\"type\":"
                                           "\"SCALAR\",\"count\":12,\"sparse\":{\"count\":1,"
                                           "\"indices\":{\"bufferView\":2,\"componentType\":5121},"
                                           "\"values\":{\"bufferView\":1,\"byteOffset\":10}}}",
                         .views = "{\"buffer\":0,\"byteLength\":72},"
                                  "{\"buffer\":0,\"byteOffset\":72,\"byteLength\":26},"
                                  "{\"buffer\":0,\"byteOffset\":96,\"byteLength\":1}",
                         .indices = (const uint16_t[]){0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4, 11, 0},
                         .n_indices = 14,
                         .primitive = "\"mode\":4"});
    EXPECT_FACE(&cage, 3, 1, 5, 3);
    cage_finish(&cage);
}

static void test_sparse_errors(void **state)
{
    (void)state;
#define SPARSE(base, count, indices, values)                                                       \
    "{" base "\"componentType\":5126,\"type\":\"VEC3\",\"count\":6,\"sparse\":{\"count\":" count   \
    ",\"indices\":{" indices "},\"values\":{" values "}}}," PAIR_ACCESSOR
#define BASE "\"bufferView\":0,"
#define SHORTS "\"bufferView\":1,\"componentType\":5123"
    static const struct {
        const char *accessors, *message;
    } bad[] = {
        /* The bytes of PAIR are read as sparse indices; PAIR begins with 0 1 4 0. */
        {SPARSE(BASE, "4", SHORTS, BASE "\"byteOffset\":0"),
         "mesh 0 primitive 0: sparse.indices of POSITION[3] does not ascend"},
        {SPARSE(BASE, "2", SHORTS ",\"byteOffset\":10", BASE "\"byteOffset\":0"),
         "mesh 0 primitive 0: sparse.indices of POSITION[1] does not ascend"},
        {SPARSE(BASE, "1", "\"bufferView\":0,\"byteOffset\":14,\"componentType\":5123",
                BASE "\"byteOffset\":0"),
         "mesh 0 primitive 0: sparse.indices of POSITION[0] is 16256, but there are 6 elements"},
        {SPARSE(BASE, "7", SHORTS, BASE "\"byteOffset\":0"),
         "mesh 0 primitive 0: POSITION replaces 7 of its 6 elements"},
        {SPARSE(BASE, "0", SHORTS, BASE "\"byteOffset\":0"),
         "mesh 0 primitive 0: POSITION replaces 0 of its 6 elements"},
        {SPARSE(BASE, "-1", SHORTS, BASE "\"byteOffset\":0"),
         "mesh 0 primitive 0: POSITION replaces -1 of its 6 elements"},
        {SPARSE(BASE, "1", "\"bufferView\":1,\"componentType\":5122", BASE "\"byteOffset\":0"),
         "mesh 0 primitive 0: sparse.indices of POSITION must be unsigned integers"},
        {SPARSE(BASE, "1", "\"bufferView\":7,\"componentType\":5123", BASE "\"byteOffset\":0"),
         "mesh 0 primitive 0: sparse.indices of POSITION has buffer view 7, but there are 2"},
        {SPARSE(BASE, "1", SHORTS ",\"byteOffset\":23", BASE "\"byteOffset\":0"),
         "mesh 0 primitive 0: sparse.indices of POSITION has 1 elements, more than its buffer"},
        {SPARSE(BASE, "3", SHORTS, BASE "\"byteOffset\":37"),
         "mesh 0 primitive 0: sparse.values of POSITION has 3 elements, more than its buffer"},
        {SPARSE(BASE, "1", SHORTS, "\"bufferView\":-1"),
         "mesh 0 primitive 0: sparse.values of POSITION has buffer view -1, but there are 2"},
        {SPARSE(BASE, "1", SHORTS, BASE "\"byteOffset\":-4"),
         "accessor 0: byteOffset is -4; it must be a whole number from 0 up"},
        {SPARSE(BASE, "1", SHORTS, BASE "\"byteOffset\":2147483648"),
         "accessor 0: byteOffset is 2147483648; it must be a whole number from 0 up"},
        {SPARSE(BASE, "1", SHORTS ",\"byteOffset\":1e1", "\"bufferView\":0"),
         "accessor 0: byteOffset is 1e1; it must be a whole number from 0 up"},
        {SPARSE(BASE, "1", SHORTS ",\"byte\\u004fffset\":1", "\"bufferView\":0"),
         "a key of accessor 0 is spelt with escapes"},
        {"{\"componentType\":5126,\"type\":\"VEC3\",\"count\":100000000000,\"sparse\":{\"count\":1,"
         "\"indices\":{" SHORTS "},\"values\":{\"bufferView\":0}}}," PAIR_ACCESSOR,
         "mesh 0 primitive 0: POSITION has 100000000000 elements without a buffer view, more than "
         "the file has bytes"},
        {"{\"bufferView\":0,\"componentType\":5126,\"type\":\"VEC3\",\"count\":6,\"sparse\":{"
         "\"count\":1}}," PAIR_ACCESSOR,
         "not a glTF file that can be read: "},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char message[200];
        snprintf(message, sizeof message, "part.glb: %s", bad[i].message);
        expect_bad(&(struct sample){.accessors = bad[i].accessors}, message);
    }
}

/* Morph targets */

static void expect_morphed(const char *nodes, const char *mesh, double z, const char *warnings)
{
    struct cage cage;
    read_good(&cage,
              &(struct sample){
                  .nodes = nodes,
                  .mesh = mesh,
                  .primitive = "\"extensions\":{\"FB_ngon_encoding\":{}},"
                               "\"targets\":[{\"POSITION\":2},{\"NORMAL\":0}]",
                  /* A sparse target moves vertex 1 alone, by the position of GRID's vertex 1. */
                  .accessors = GRID_ACCESSOR
                  "," PAIR_ACCESSOR
                  ",{\"componentType\":5126,\"type\":\"VEC3\",\"count\":6,\"sparse\":{\"count\":1,"
                  "\"indices\":{\"bufferView\":1,\"byteOffset\":2,\"componentType\":5123},"
                  "\"values\":{\"bufferView\":0,\"byteOffset\":12}}}"});
    expect_position(&cage, 1, 1 + z, 0, 0);
    expect_position(&cage, 2, 2, 0, 0);
    if (warnings)
        assert_string_equal(cage.warnings, warnings);
    else
        assert_null(cage.warnings);
    cage_finish(&cage);
}

static void test_morph(void **state)
{
    (void)state;
    static const char rest[] = "part.glb: its morph targets have weight 0: the rest shape is shown";
    static const char odd[] = "part.glb: a mesh has other numbers of morph targets and of weights: "
                              "its rest shape is shown";
    expect_morphed(NULL, NULL, 0, rest);
    expect_morphed(NULL, ",\"weights\":[0,0]", 0, rest);
    expect_morphed(NULL, ",\"weights\":[0.25,0]", 0.25, NULL);
    expect_morphed(NULL, ",\"weights\":[-0.5,1]", -0.5, NULL);
    expect_morphed(NULL, ",\"weights\":[0,1]", 0, NULL);
    expect_morphed("{\"mesh\":0,\"weights\":[0.5,0]}", ",\"weights\":[0.25,0]", 0.5, NULL);
    expect_morphed("{\"mesh\":0,\"weights\":[0,0]}", ",\"weights\":[0.25,0]", 0, rest);
    expect_morphed(NULL, ",\"weights\":[1]", 0, odd);
    expect_morphed("{\"mesh\":0,\"weights\":[1,2,3]}", ",\"weights\":[1,1]", 0, odd);
    expect_bad(&(struct sample){.mesh = ",\"weights\":[1]",
                                .primitive = "\"targets\":[{\"POSITION\":2}]",
                                .accessors = GRID_ACCESSOR
                                "," PAIR_ACCESSOR
                                ",{\"bufferView\":0,\"componentType\":5126,\"type\":\"VEC3\","
                                "\"count\":5}"},
               "part.glb: mesh 0 primitive 0: a morph target has 5 vertices, POSITION 6");
    expect_bad(
        &(struct sample){.mesh = ",\"weights\":[1]", .primitive = "\"targets\":[{\"POSITION\":9}]"},
        "part.glb: mesh 0 primitive 0: POSITION of a morph target refers to accessor 9");
}

/* Two primitives have the same POSITION and morph it by the same accessor, with different
 * weights. */
static void test_morphs_by_weight(void **state)
{
    (void)state;
    static const uint16_t triangle[] = {0, 1, 2};
    static const float positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    struct cage cage;
    read_good(&cage, &(struct sample){
                         .positions = positions,
                         .n_positions = 3,
                         .indices = triangle,
                         .n_indices = 3,
                         .meshes = "{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"targets\":["
                                   "{\"POSITION\":0},{\"NORMAL\":0}]},{\"attributes\":{"
                                   "\"POSITION\":0},\"targets\":[{\"NORMAL\":0},{"
                                   "\"POSITION\":0}]}],\"weights\":[1,2]}"});
    assert_int_equal(cage.n_faces, 2);
    /* both primitives have one vertex at the origin, which is welded */
    assert_int_equal(cage.n_vertices, 5);
    expect_position(&cage, cage.face_vertex[1], 2, 0, 0);
    expect_position(&cage, cage.face_vertex[4], 3, 0, 0);
    cage_finish(&cage);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_strips_and_fans),  cmocka_unit_test(test_strip_joints),
        cmocka_unit_test(test_quantized),        cmocka_unit_test(test_sparse),
        cmocka_unit_test(test_sparse_errors),    cmocka_unit_test(test_morph),
        cmocka_unit_test(test_morphs_by_weight),
    };
    return cmocka_run_group_tests_name("cage/gltf_forms", tests, NULL, NULL);
}
