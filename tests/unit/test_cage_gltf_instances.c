/* EXT_mesh_gpu_instancing, and positions that nodes make of those in the file. */
#include "server/cage/read/read.h"
#include "tests/unit/gltf_sample.h"

#include <math.h>

#define GRID_ACCESSOR "{\"bufferView\":0,\"componentType\":5126,\"type\":\"VEC3\",\"count\":6}"
#define PAIR_ACCESSOR "{\"bufferView\":1,\"componentType\":5123,\"type\":\"SCALAR\",\"count\":12}"

#define INSTANCED(attributes)                                                                      \
    "{\"mesh\":0,\"translation\":[100,0,0],\"extensions\":{\"EXT_mesh_gpu_instancing\":{"          \
    "\"attributes\":{" attributes "}}}}"
/* The buffer: GRID, then three translations, three scales and three rotations, as floats. */
/* clang-format off */
static const float INSTANCES[] = {
    0, 0, 0, 1, 0, 0, 2, 0, 0, 0, 1, 0, 1, 1, 0, 2, 1, 0, /* GRID */
    5, 0, 0, 0, 6, 0, 0, 0, 7,
    1, 1, 1, 2, 3, 4, -1, 1, 1,
    /* quaternions, also used as normalized shorts; they need not have unit length */
    0, 0, 0, 1, 2, 0, 0, 0, 0, 0, 1, 1,
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

    /* An instance is scaled, then rotated, then translated; the third instance is mirrored. */
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

/* A million and one instances of a mesh without vertices. */
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
    memcpy(at, "\"nodes\":[ ]", 11); /* then two nodes with 600000 instances each */
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

/* Sparse accessors without values are zeros that take no bytes of the file. They weld to one
 * vertex, but each instance counts all of them, so that the limit is met before anything is
 * read. */
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
        /* the zeros behind these make the file as long as the vertices need */
        static uint16_t indices[30000] = {0, 1, 2};
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

/* Numbers in the file are finite, but their products are not. */
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_instancing),
        cmocka_unit_test(test_instancing_errors),
        cmocka_unit_test(test_too_many_instances),
        cmocka_unit_test(test_instances_of_zeros),
        cmocka_unit_test(test_positions_without_a_place),
    };
    return cmocka_run_group_tests_name("cage/gltf_instances", tests, NULL, NULL);
}
