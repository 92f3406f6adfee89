/* What glTF 2.0 and its extensions allow beside indexed triangles of floats. */
#include "server/cage/read/read.h"
#include "tests/unit/gltf_sample.h"

#include <math.h>

#define GRID_ACCESSOR "{\"bufferView\":0,\"componentType\":5126,\"type\":\"VEC3\",\"count\":6}"
#define PAIR_ACCESSOR "{\"bufferView\":1,\"componentType\":5123,\"type\":\"SCALAR\",\"count\":12}"

/* A generator of its own, so that each run asks the same. */
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

/* A band along x and a disc round vertex 0, both counter-clockwise: each triangle's own area says
 * whether it is wound so, and the sum whether one is missing or twice. */
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

/* A strip is cut by repeating a vertex; what comes of that is no face. */
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
    /* FB_ngon_encoding speaks of separate triangles: a fan stays one triangle each. */
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
        uint16_t bits[6]; /* of one vertex: three integers of 8 bits and a gap, or of 16 */
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
        size_t stride = narrow ? 2 : 4; /* in uint16_t */
        uint16_t bits[12] = {0};
        for (size_t v = 0; v < 3; v++)
            memcpy(&bits[v * stride], forms[i].bits, stride * sizeof *bits);
        bits[stride] ^= 0x0101; /* vertices that differ, so that there is a face */
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

/* Sparse accessors: the same file, its replaced elements written out, is the same cage. */

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
    memcpy(indices, &indices[3 * N], 3 * sizeof *indices); /* one face at least */
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
    /* Indices may be sparse too: the last of PAIR becomes 3. */
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
        /* PAIR begins with 0 1 4 0. */
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

/* EXT_mesh_gpu_instancing */

#define INSTANCED(attributes)                                                                      \
    "{\"mesh\":0,\"translation\":[100,0,0],\"extensions\":{\"EXT_mesh_gpu_instancing\":{"          \
    "\"attributes\":{" attributes "}}}}"
/* Behind GRID: three translations, three scales, three rotations of floats. */
/* clang-format off */
static const float INSTANCES[] = {
    0, 0, 0, 1, 0, 0, 2, 0, 0, 0, 1, 0, 1, 1, 0, 2, 1, 0, /* GRID */
    5, 0, 0, 0, 6, 0, 0, 0, 7,
    1, 1, 1, 2, 3, 4, -1, 1, 1,
    0, 0, 0, 1, 2, 0, 0, 0, 0, 0, 1, 1, /* as they stand in the shorts, of any length */
    NAN, 0, 0, 0, 0, 0,
};
/* clang-format on */
static const char INSTANCE_ACCESSORS[] = GRID_ACCESSOR
    "," PAIR_ACCESSOR
    ",{\"bufferView\":0,\"byteOffset\":72,\"componentType\":5126,\"type\":\"VEC3\",\"count\":3}"
    ",{\"bufferView\":0,\"byteOffset\":108,\"componentType\":5126,\"type\":\"VEC3\",\"count\":3}"
    ",{\"bufferView\":0,\"byteOffset\":144,\"componentType\":5126,\"type\":\"VEC4\",\"count\":3}"
    ",{\"bufferView\":1,\"byteOffset\":24,\"componentType\":5122,\"normalized\":true,\"type\":"
    "\"VEC4\",\"count\":3}"
    ",{\"bufferView\":0,\"byteOffset\":72,\"componentType\":5126,\"type\":\"VEC3\",\"count\":2}"
    ",{\"bufferView\":0,\"byteOffset\":192,\"componentType\":5126,\"type\":\"VEC3\",\"count\":1}"
    ",{\"bufferView\":1,\"componentType\":5123,\"type\":\"VEC3\",\"count\":3}"
    ",{\"componentType\":5126,\"type\":\"VEC3\",\"count\":%s,\"sparse\":{\"count\":1,\"indices\":{"
    "\"bufferView\":1,\"componentType\":5123},\"values\":{\"bufferView\":0}}}";

static struct sample instanced(const char *node, char *accessors, size_t size, const char *count)
{
    /* As normalized shorts: no turn, a half turn about x, a quarter turn about z. */
    static const uint16_t indices[] = {0,      1, 4, 0, 4, 3, 1,     2,
                                       5,      1, 5, 4, 0, 0, 0,     0x7fff, /**/
                                       0x7fff, 0, 0, 0, 0, 0, 23170, 23170};
    snprintf(accessors, size, INSTANCE_ACCESSORS, count);
    return (struct sample){.nodes = node,
                           .accessors = accessors,
                           .positions = INSTANCES,
                           .n_positions = 18,
                           .indices = indices,
                           .n_indices = 24,
                           .views = "{\"buffer\":0,\"byteLength\":216},"
                                    "{\"buffer\":0,\"byteOffset\":216,\"byteLength\":48}"};
}

static void expect_near(const struct cage *cage, size_t vertex, double x, double y, double z)
{
    const double *p = cage->position[vertex];
    if (!(fabs(p[0] - x) < 1e-6 && fabs(p[1] - y) < 1e-6 && fabs(p[2] - z) < 1e-6))
        fail_msg("vertex %zu is %g %g %g, not %g %g %g", vertex, p[0], p[1], p[2], x, y, z);
}

static void test_instancing(void **state)
{
    (void)state;
    char text[2000];
    struct cage cage;
    struct sample sample = instanced(INSTANCED("\"TRANSLATION\":2"), text, sizeof text, "1");
    read_good(&cage, &sample);
    assert_int_equal(cage.n_faces, 6);
    assert_int_equal(cage.n_vertices, 18);
    expect_position(&cage, 5, 107, 1, 0);
    expect_position(&cage, 11, 102, 7, 0);
    expect_position(&cage, 17, 102, 1, 7);
    cage_finish(&cage);

    /* Scale, then turn, then move; the third is mirrored. */
    static const char *const rotations[] = {
        INSTANCED("\"TRANSLATION\":2,\"ROTATION\":5,\"SCALE\":3,\"_ID\":1"),
        INSTANCED("\"SCALE\":3,\"ROTATION\":4,\"TRANSLATION\":2"),
    };
    for (int i = 0; i < 2; i++) {
        sample = instanced(rotations[i], text, sizeof text, "1");
        read_good(&cage, &sample);
        expect_near(&cage, 5, 107, 1, 0);
        expect_near(&cage, 11, 104, 3, 0);
        expect_near(&cage, 17, 99, -2, 7);
        EXPECT_FACE(&cage, 0, 0, 1, 4, 3);
        EXPECT_FACE(&cage, 4, 12, 15, 16, 13);
        cage_finish(&cage);
    }
}

static void test_instancing_errors(void **state)
{
    (void)state;
    static const struct {
        const char *node, *count, *message;
    } bad[] = {
        {INSTANCED("\"TRANSLATION\":2,\"SCALE\":6"), "1",
         "SCALE has 2 elements, another attribute has 3"},
        {INSTANCED("\"TRANSLATION\":7"), "1", "TRANSLATION 0 is not finite"},
        {INSTANCED("\"TRANSLATION\":4"), "1", "TRANSLATION must be VEC3 of floats"},
        {INSTANCED("\"TRANSLATION\":8"), "1", "TRANSLATION must be VEC3 of floats"},
        {INSTANCED("\"ROTATION\":2"), "1",
         "ROTATION must be VEC4 of floats or normalized integers"},
        {INSTANCED("\"TRANSLATION\":99"), "1",
         "TRANSLATION refers to accessor 99, but there are 10"},
        {INSTANCED("\"TRANSLATION\":\"2\""), "1",
         "TRANSLATION refers to accessor -1, but there are 10"},
        {INSTANCED("\"_ID\":1"), "1", "none of TRANSLATION, ROTATION and SCALE says how many"},
        {INSTANCED("\"SCALE\":9"), "1000000000", "SCALE has 1000000000 elements without a buffer"},
        {"{\"mesh\":0,\"extensions\":{\"EXT_mesh_gpu_instancing\":{}}}", "1", "it has no"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char text[2000], message[200];
        struct sample sample = instanced(bad[i].node, text, sizeof text, bad[i].count);
        snprintf(message, sizeof message, "part.glb: node 0, EXT_mesh_gpu_instancing: %s",
                 bad[i].message);
        expect_bad(&sample, message);
    }
}

/* A million and one instances of a mesh that is nothing. */
static void test_too_many_instances(void **state)
{
    (void)state;
    enum { N = 1000001 };
    char json[1000];
    snprintf(json, sizeof json,
             "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}],\"nodes\":[%s],"
             "\"meshes\":[{}],\"buffers\":[{\"byteLength\":%d}],\"bufferViews\":[{\"buffer\":0,"
             "\"byteLength\":%d}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,"
             "\"type\":\"VEC3\",\"count\":%d}]}",
             INSTANCED("\"TRANSLATION\":0"), N * 12, N * 12, N);
    float *zeros = calloc(N, 12);
    assert_non_null(zeros);
    struct bytes file = make_glb(json, zeros, (size_t)N * 12);
    expect_bytes_bad(file.data, file.size,
                     "part.glb: node 0, EXT_mesh_gpu_instancing: TRANSLATION has 1000001 elements, "
                     "at most 1000000 are read");
    free(file.data);
    char *at = strstr(json, "\"count\":1000001");
    memcpy(at, "\"count\":0600000", 15);
    at[8] = ' ';
    at = strstr(json, "\"nodes\":[0]");
    memcpy(at, "\"nodes\":[ ]", 11); /* and then two nodes of 600000 each */
    char two[1500];
    snprintf(two, sizeof two, "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[%s,%s],%s",
             INSTANCED("\"TRANSLATION\":0"), INSTANCED("\"TRANSLATION\":0"),
             strstr(json, "\"meshes\""));
    file = make_glb(two, zeros, (size_t)N * 12);
    expect_bytes_bad(file.data, file.size,
                     "part.glb: its nodes show meshes more than 1000000 times");
    free(file.data);
    free(zeros);
}

/* Zeros that weld to one vertex and cost the file nothing are counted for all instances, and then
 * not read. */
static void test_instances_of_zeros(void **state)
{
    (void)state;
    static const struct {
        const char *vertices, *message; /* NULL: good */
    } cases[] = {
        {"50001", "part.glb: node 0: with its instances the scene has 100002000 vertices before "
                  "equal ones are joined; at most 100000000 are read"},
        {"500", NULL},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
#define ZEROS                                                                                      \
    "\"componentType\":5126,\"type\":\"VEC3\",\"sparse\":{\"count\":3,\"indices\":{"               \
    "\"bufferView\":1,\"componentType\":5123},\"values\":{\"bufferView\":0}}}"
        char accessors[700];
        int n = snprintf(accessors, sizeof accessors,
                         "{\"count\":%s," ZEROS ",{\"bufferView\":1,\"componentType\":5123,"
                         "\"type\":\"SCALAR\",\"count\":3},{\"count\":2000," ZEROS,
                         cases[i].vertices);
        assert_true(n > 0 && (size_t)n < sizeof accessors);
        static uint16_t indices[30000] = {0, 1, 2}; /* the rest makes the file as long */
        struct sample sample = {.nodes = "{\"mesh\":0,\"extensions\":{\"EXT_mesh_gpu_instancing\":{"
                                         "\"attributes\":{\"TRANSLATION\":2}}}}",
                                .accessors = accessors,
                                .positions = GRID + 3,
                                .n_positions = 3,
                                .indices = indices,
                                .n_indices = sizeof indices / sizeof *indices};
        struct cage cage;
        if (cases[i].message) {
            expect_bad(&sample, cases[i].message);
        } else {
            read_good(&cage, &sample);
            assert_int_equal(cage.n_faces, 2000);
            assert_int_equal(cage.n_vertices, 4 * 2000);
            cage_finish(&cage);
        }
    }
}

/* Finite numbers in the file whose products are not. */
static void test_positions_without_a_place(void **state)
{
    (void)state;
    expect_bad(&(struct sample){.nodes = "{\"mesh\":0,\"matrix\":[1e300,0,0,0,-1e300,1,0,0,0,0,1,0,"
                                         "0,0,0,1],\"children\":[1]},{\"mesh\":0}",
                                .positions = (const float[]){1e30f, 1e30f, 0, 1, 0, 0, 0, 1, 0},
                                .n_positions = 3,
                                .indices = (const uint16_t[]){0, 1, 2},
                                .n_indices = 3},
               "part.glb: mesh 0 primitive 0: POSITION 0 is not finite where a node puts it");
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
                  /* Only vertex 1 moves, by GRID's vertex 1. */
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

/* Two primitives share POSITION and take one morph target, with weights of their own. */
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
    assert_int_equal(cage.n_vertices, 5); /* the origin is one */
    expect_position(&cage, cage.face_vertex[1], 2, 0, 0);
    expect_position(&cage, cage.face_vertex[4], 3, 0, 0);
    cage_finish(&cage);
}

/* What is passed over */

static void expect_pair(const struct sample *sample, const char *warnings)
{
    struct cage cage;
    read_good(&cage, sample);
    assert_int_equal(cage.n_faces, 2);
    EXPECT_FACE(&cage, 0, 0, 1, 4, 3);
    if (warnings)
        assert_string_equal(cage.warnings, warnings);
    else
        assert_null(cage.warnings);
    cage_finish(&cage);
}

static void test_passed_over(void **state)
{
    (void)state;
    /* All of these are what tinygltf refuses, or would read beyond the file for. */
    static const char *const members[] = {
        "\"skins\":[{\"joints\":[0]}],",
        "\"skins\":[{}],",
        "\"animations\":[{\"channels\":[{\"sampler\":0,\"target\":{\"path\":\"pointer\","
        "\"extensions\":{\"KHR_animation_pointer\":{\"pointer\":\"/nodes/0/scale\"}}}}],"
        "\"samplers\":[{\"input\":0,\"output\":0}]}],",
        "\"animations\":[{}],",
        "\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorFactor\":[1]}}],",
        "\"cameras\":[{\"type\":\"fisheye\"}],",
        "\"images\":[{\"uri\":\"https://example.com/x.png\"},{\"bufferView\":99},1],",
        "\"textures\":[[]],\"samplers\":[7],",
        "\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"spot\"}]}},",
        "\"extensions\":{\"KHR_xmp_json_ld\":{\"packets\":[{\"a\":\"]}\"}]}},",
    };
    for (size_t i = 0; i < sizeof members / sizeof *members; i++)
        expect_pair(&(struct sample){.top = members[i]}, NULL);
    expect_pair(&(struct sample){.top = "\"skins\":[{\"joints\":[0]}],",
                                 .nodes = "{\"mesh\":0,\"skin\":0}"},
                "part.glb: skins are passed over: the cage stands in its bind pose");
    /* A broken member ends where its brackets do, not later. */
    expect_text_bad("{\"asset\":{\"version\":\"2.0\"},\"skins\":[{]}", "part.glb: ");
    expect_text_bad("{\"asset\":{\"version\":\"2.0\"},\"skins\":[", "part.glb: not a glTF file");
}

static void test_points_and_lines(void **state)
{
    (void)state;
    expect_pair(
        &(struct sample){
            .meshes = "{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"mode\":0},"
                      "{\"attributes\":{\"POSITION\":0},\"indices\":1,\"extensions\":{"
                      "\"FB_ngon_encoding\":{}}},{\"attributes\":{\"POSITION\":99},\"mode\":3},"
                      "{\"attributes\":{\"NORMAL\":0}}]}"},
        "part.glb: points and lines are passed over, primitives: 2\n"
        "part.glb: primitives without POSITION are passed over: 1");
}

static void test_hidden_nodes(void **state)
{
    (void)state;
    expect_pair(&(struct sample){.scene = "\"scene\":0,\"scenes\":[{\"nodes\":[0,1,2]}]",
                                 .nodes = "{\"mesh\":0,\"children\":[3],\"extensions\":{"
                                          "\"KHR_node_visibility\":{\"visible\":false}}},"
                                          "{\"mesh\":0,\"extensions\":{\"KHR_node_visibility\":{"
                                          "\"visible\":true}}},{},{\"mesh\":0}"},
                "part.glb: nodes that KHR_node_visibility hides are passed over: 1");
    expect_bad(&(struct sample){.nodes = "{\"mesh\":0,\"extensions\":{\"KHR_node_visibility\":{"
                                         "\"visible\":false}}}"},
               "part.glb: KHR_node_visibility hides all that it holds");
}

static void test_scenes(void **state)
{
    (void)state;
    expect_pair(&(struct sample){.scene = "\"scenes\":[{\"nodes\":[0]},{},{}]"},
                "part.glb: 1 of its 3 scenes is read, the first: it names no default");
    expect_pair(&(struct sample){.scene = "\"scene\":0,\"scenes\":[{\"nodes\":[0]},{}]"}, NULL);
}

static void test_extensions(void **state)
{
    (void)state;
    static const char *const good[] = {
        "FB_ngon_encoding",    "EXT_mesh_gpu_instancing", "KHR_mesh_quantization",
        "KHR_materials_unlit", "KHR_texture_basisu",      "KHR_xmp_json_ld",
        "KHR_lights_punctual", "KHR_animation_pointer",   "VRMC_vrm",
        "EXT_texture_webp",
    };
    static const struct {
        const char *name, *message;
    } bad[] = {
        {"KHR_draco_mesh_compression", "its geometry is packed with KHR_draco_mesh_compression, "
                                       "which is not read: export it without compression"},
        {"EXT_meshopt_compression", "its geometry is packed with EXT_meshopt_compression"},
        {"KHR_meshopt_compression", "its geometry is packed with KHR_meshopt_compression"},
        {"CESIUM_RTC", "it requires the extension 'CESIUM_RTC', which is not read"},
        {"", "it requires the extension '', which is not read"},
        {"FB_ngon_encoding2", "it requires the extension 'FB_ngon_encoding2', which is not read"},
        {"KHR_materials", "it requires the extension 'KHR_materials', which is not read"},
        {"\\u0046B_ngon_encoding", "the name of an extension is spelt with escapes"},
    };
    char top[200], message[200];
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        snprintf(top, sizeof top, "\"extensionsRequired\":[\"KHR_xmp\",\"%s\"],", good[i]);
        expect_pair(&(struct sample){.top = top}, NULL);
    }
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        snprintf(top, sizeof top, "\"extensionsRequired\":[\"KHR_xmp\",\"%s\"],", bad[i].name);
        snprintf(message, sizeof message, "part.glb: %s", bad[i].message);
        expect_bad(&(struct sample){.top = top}, message);
    }
    /* Used alone, nothing is refused by its name but what is not there without it. */
    expect_pair(&(struct sample){.top = "\"extensionsUsed\":[\"CESIUM_RTC\","
                                        "\"KHR_draco_mesh_compression\"],"},
                NULL);
    static const char packed[] = "part.glb: its geometry is packed with KHR_draco_mesh_compression";
    expect_bad(&(struct sample){.top = "\"extensionsUsed\":[\"KHR_draco_mesh_compression\"],",
                                .accessors = "{\"componentType\":5126,\"type\":\"VEC3\","
                                             "\"count\":6}," PAIR_ACCESSOR},
               packed);
    expect_bad(&(struct sample){.top = "\"extensionsUsed\":[\"KHR_draco_mesh_compression\"],",
                                .accessors = GRID_ACCESSOR ",{\"componentType\":5123,\"type\":"
                                                           "\"SCALAR\",\"count\":12}"},
               packed);
    /* A buffer that is the fallback of packed views holds nothing. */
    struct sample fallback = {.top = "\"extensionsUsed\":[\"EXT_meshopt_compression\"],",
                              .buffers = "{\"byteLength\":96},{\"byteLength\":72}",
                              .views = "{\"buffer\":1,\"byteLength\":72},"
                                       "{\"buffer\":0,\"byteOffset\":72,\"byteLength\":24}"};
    expect_bad(&fallback, "part.glb: its geometry is packed with EXT_meshopt_compression");
    fallback.top = NULL;
    expect_bad(&fallback,
               "part.glb: mesh 0 primitive 0: POSITION has buffer 1, which holds no data");
}

static void test_first_version(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "{\"asset\":{\"version\":\"1.0\"},\"meshes\":[]}",
        "{\"asset\":{\"generator\":\"x\",\"version\" : \"1.1\"}}",
        "{\"asset\":{\"version\":1.0}}",
        "{\"meshes\":{\"m\":{\"primitives\":[]}},\"asset\":{}}",
    };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        expect_text_bad(texts[i], "part.glb: glTF 1.0; only 2.0 is read: export it as 2.0");
    expect_pair(&(struct sample){.top = "\"extras\":{\"asset\":{\"version\":\"1.0\"}},"}, NULL);
}

/* Chunks of any length: what counts them in the header, and what pads without counting. */
static void test_unaligned_chunks(void **state)
{
    (void)state;
    struct bytes file = make_file(&(struct sample){0});
    size_t json_size = file.size - 20 - 8 - 96;
    while (file.data[20 + json_size - 1] == ' ')
        json_size--;
    for (size_t odd = 0; odd < 24; odd++) {
        size_t blanks = odd % 4, tail = odd / 4 % 3, gap = odd / 12;
        size_t json = json_size + blanks, gap_bytes = gap ? (4 - json % 4) % 4 : 0, bin = 96 + tail;
        unsigned char *data = calloc(1, 20 + json + gap_bytes + 8 + bin);
        assert_non_null(data);
        memcpy(data, file.data, 20 + json_size);
        memset(data + 20 + json_size, ' ', blanks + gap_bytes);
        unsigned char *chunk = data + 20 + json + gap_bytes;
        memcpy(chunk, file.data + file.size - 104, 104);
        put_u32(data + 8, (uint32_t)(20 + json + gap_bytes + 8 + bin));
        put_u32(data + 12, (uint32_t)json);
        put_u32(chunk, (uint32_t)bin);
        struct cage cage;
        struct error error = {0};
        if (!cage_read(&cage, data, 20 + json + gap_bytes + 8 + bin, "part.glb", &error))
            fail_msg("JSON of %zu, BIN of %zu bytes: %s", json, bin, error.text);
        assert_int_equal(cage.n_faces, 2);
        expect_position(&cage, 5, 2, 1, 0);
        if (json % 4 == 0 && bin % 4 == 0)
            assert_null(cage.warnings);
        else
            assert_string_equal(cage.warnings,
                                "part.glb: the chunks of the GLB are not on multiples of 4 bytes; "
                                "its writer is at fault");
        cage_finish(&cage);
        free(data);
    }
    free(file.data);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_strips_and_fans),
        cmocka_unit_test(test_strip_joints),
        cmocka_unit_test(test_quantized),
        cmocka_unit_test(test_sparse),
        cmocka_unit_test(test_sparse_errors),
        cmocka_unit_test(test_instancing),
        cmocka_unit_test(test_instancing_errors),
        cmocka_unit_test(test_too_many_instances),
        cmocka_unit_test(test_morph),
        cmocka_unit_test(test_morphs_by_weight),
        cmocka_unit_test(test_instances_of_zeros),
        cmocka_unit_test(test_positions_without_a_place),
        cmocka_unit_test(test_passed_over),
        cmocka_unit_test(test_points_and_lines),
        cmocka_unit_test(test_hidden_nodes),
        cmocka_unit_test(test_scenes),
        cmocka_unit_test(test_extensions),
        cmocka_unit_test(test_first_version),
        cmocka_unit_test(test_unaligned_chunks),
    };
    return cmocka_run_group_tests_name("cage/gltf_forms", tests, NULL, NULL);
}
