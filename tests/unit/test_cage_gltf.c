/* The glTF reader: polygons, welding, nodes, index types, and our own model. */
#include "server/cage/read/read.h"
#include "tests/unit/gltf_sample.h"

#include <math.h>

/* Polygons */

static void test_quads(void **state)
{
    (void)state;
    struct cage cage;
    read_good(&cage, &(struct sample){0});
    assert_int_equal(cage.n_vertices, 6);
    assert_int_equal(cage.n_faces, 2);
    EXPECT_FACE(&cage, 0, 0, 1, 4, 3);
    EXPECT_FACE(&cage, 1, 1, 2, 5, 4);
    expect_position(&cage, 5, 2, 1, 0);
    assert_null(cage.warnings);
    assert_int_equal(cage.boundary, CAGE_BOUNDARY_EDGE_ONLY);
    assert_int_equal(cage.up, CAGE_UP_Y);
    cage_finish(&cage);
}

static void test_polygons(void **state)
{
    (void)state;
    /* A hexagon around vertex 0, then a triangle with another first vertex, then a quad that starts
     * at 0 again. */
    static const uint16_t fan[] = {0, 1, 2, 0, 2, 5, 0, 5, 4, 0, 4, 3, 1, 2, 4, 0, 1, 4, 0, 4, 3};
    struct cage cage;
    read_good(&cage, &(struct sample){.indices = fan, .n_indices = 21});
    assert_int_equal(cage.n_faces, 3);
    EXPECT_FACE(&cage, 0, 0, 1, 2, 5, 4, 3);
    EXPECT_FACE(&cage, 1, 1, 2, 4);
    EXPECT_FACE(&cage, 2, 0, 1, 4, 3);
    cage_finish(&cage);
}

static void test_plain_triangles(void **state)
{
    (void)state;
    struct cage cage;
    read_good(&cage, &(struct sample){.primitive = "\"mode\":4"});
    assert_int_equal(cage.n_faces, 4);
    EXPECT_FACE(&cage, 1, 0, 4, 3);
    assert_string_equal(cage.warnings,
                        "part.glb: plain triangles: Catmull-Clark over triangles, probably not "
                        "what was modelled; export quads as OBJ or with FB_ngon_encoding");
    cage_finish(&cage);
    /* A Loop surface is meant to have triangles, so there is no warning. */
    read_good(&cage, &(struct sample){.primitive = "\"extras\":{\"subdivisionScheme\":\"loop\"}"});
    assert_int_equal(cage.scheme, CAGE_SCHEME_LOOP);
    assert_null(cage.warnings);
    cage_finish(&cage);
}

static void test_no_indices(void **state)
{
    (void)state;
    struct cage cage;
    read_good(&cage, &(struct sample){.meshes = "{\"primitives\":[{\"attributes\":{\"POSITION\":0}"
                                                "}]}"});
    assert_int_equal(cage.n_faces, 2);
    EXPECT_FACE(&cage, 1, 3, 4, 5);
    cage_finish(&cage);
}

/* Two triangles that have the same first vertex but no common edge make two faces and a warning. */
static void test_broken_polygons(void **state)
{
    (void)state;
    static const uint16_t broken[] = {1, 2, 5, 1, 4, 3};
    struct cage cage;
    read_good(&cage, &(struct sample){.indices = broken, .n_indices = 6});
    assert_int_equal(cage.n_faces, 2);
    EXPECT_FACE(&cage, 0, 1, 2, 5);
    EXPECT_FACE(&cage, 1, 1, 4, 3);
    assert_non_null(strstr(cage.warnings, "FB_ngon_encoding is broken, triangles "
                                          "that do not continue their polygon: 1;"));
    cage_finish(&cage);
}

/* Welding */

/* The second quad has vertices of its own, 6 to 9, at the positions of 1, 2, 5 and 4; one of their
 * zeros is negative. */
static const float SPLIT[] = {0, 0, 0, 1, 0, 0, 2, 0, 0, 0,   1, 0, 1, 1, 0,
                              2, 1, 0, 1, 0, 0, 2, 0, 0, 2.0, 1, 0, 1, 1, -0.0f};

static void test_weld(void **state)
{
    (void)state;
    static const uint16_t quads[] = {0, 1, 4, 0, 4, 3, 6, 7, 8, 6, 8, 9};
    struct cage cage;
    read_good(&cage, &(struct sample){.positions = SPLIT,
                                      .n_positions = 10,
                                      .indices = quads,
                                      .n_indices = 12,
                                      .primitive = "\"extensions\":{\"FB_ngon_encoding\":{}},"
                                                   "\"extras\":{\"creaseIndices\":[9,6,7],"
                                                   "\"creaseLengths\":[3],"
                                                   "\"creaseSharpnesses\":[2],"
                                                   "\"cornerIndices\":[8],"
                                                   "\"cornerSharpnesses\":[3]}"});
    assert_int_equal(cage.n_vertices, 6);
    EXPECT_FACE(&cage, 0, 0, 1, 4, 3);
    EXPECT_FACE(&cage, 1, 1, 2, 5, 4);
    assert_int_equal(cage.n_creases, 2);
    assert_int_equal(cage.crease[0].vertex[0], 4);
    assert_int_equal(cage.crease[0].vertex[1], 1);
    assert_int_equal(cage.crease[1].vertex[1], 2);
    assert_int_equal(cage.corner[0].vertex, 5);
    assert_null(cage.warnings);
    cage_finish(&cage);

    /* The nearest other float is another position, so it is not welded. */
    float near[30];
    memcpy(near, SPLIT, sizeof near);
    near[18] = nextafterf(near[18], 2);
    read_good(&cage, &(struct sample){
                         .positions = near, .n_positions = 10, .indices = quads, .n_indices = 12});
    assert_int_equal(cage.n_vertices, 7);
    cage_finish(&cage);
}

/* A corner that is welded to its neighbour is removed. A face with only two corners left is
 * dropped, and a hole that names a later face still names the same face. */
static void test_collapse(void **state)
{
    (void)state;
    struct cage cage;
    float moved[30];
    memcpy(moved, SPLIT, sizeof moved);
    moved[18] = 0.5f; /* 6 lies between 0 and 1; 9 lies at 4 */
    static const uint16_t to_triangle[] = {6, 1, 4, 6, 4, 9};
    read_good(&cage,
              &(struct sample){
                  .positions = moved, .n_positions = 10, .indices = to_triangle, .n_indices = 6});
    assert_int_equal(cage.n_faces, 1);
    EXPECT_FACE(&cage, 0, 6, 1, 4);
    assert_string_equal(cage.warnings, "part.glb: face 0 (counting from 0): a face names a vertex "
                                       "twice in a row: the second is dropped");
    cage_finish(&cage);

    static const uint16_t to_nothing[] = {1, 6, 7, 1, 7, 2, 0, 1, 4, 0, 4, 3};
    read_good(&cage, &(struct sample){.positions = SPLIT,
                                      .n_positions = 10,
                                      .indices = to_nothing,
                                      .n_indices = 12,
                                      .primitive = "\"extensions\":{\"FB_ngon_encoding\":{}},"
                                                   "\"extras\":{\"holeIndices\":[0,1],"
                                                   "\"creaseIndices\":[2,7,0,1],"
                                                   "\"creaseLengths\":[2,2],"
                                                   "\"creaseSharpnesses\":[1,2]}"});
    assert_int_equal(cage.n_faces, 1);
    EXPECT_FACE(&cage, 0, 0, 1, 4, 3);
    assert_int_equal(cage.n_holes, 1);
    assert_int_equal(cage.hole[0], 0);
    assert_int_equal(cage.n_creases, 1);
    assert_true(cage.crease[0].sharpness == 2);
    assert_string_equal(cage.warnings,
                        "part.glb: face 0 (counting from 0): a face with fewer than 3 different "
                        "corners is ignored\n"
                        "part.glb: a crease whose vertices share no edge is ignored");
    cage_finish(&cage);
}

/* A corner that the file repeats beside itself is removed like a corner that welding repeats, and
 * counts as the same finding. A polygon that returns to a vertex later is dropped as a whole. */
static void test_repeated_corners(void **state)
{
    (void)state;
    static const uint16_t repeated[] = {0, 1, 1, 1, 6, 2, 7, 5, 4, 5, 2, 5};
    struct cage cage;
    read_good(&cage, &(struct sample){.positions = SPLIT,
                                      .n_positions = 10,
                                      .indices = repeated,
                                      .n_indices = 12,
                                      .primitive = "\"mode\":4"});
    assert_int_equal(cage.n_faces, 1);
    EXPECT_FACE(&cage, 0, 2, 5, 4);
    assert_int_equal(cage.finding[0].kind, CAGE_FOUND_FEW_CORNERS);
    assert_int_equal(cage.finding[0].count, 3);
    assert_int_equal(cage.finding[0].line, 0);
    assert_int_equal(cage.finding[0].face, 0);
    assert_non_null(strstr(cage.warnings,
                           "part.glb: face 0 (counting from 0): a face with fewer than 3 different "
                           "corners is ignored; 3 in all, this is the first"));
    cage_finish(&cage);
    static const uint16_t in_polygons[] = {0, 1, 1, 0, 1, 3, 1, 2, 5, 1, 5, 1};
    read_good(&cage, &(struct sample){.indices = in_polygons, .n_indices = 12});
    assert_int_equal(cage.n_faces, 2);
    EXPECT_FACE(&cage, 0, 0, 1, 3);
    EXPECT_FACE(&cage, 1, 1, 2, 5);
    assert_int_equal(cage.finding[0].kind, CAGE_FOUND_REPEATED_CORNER);
    assert_int_equal(cage.finding[0].count, 2);
    cage_finish(&cage);
    static const uint16_t bow_tie[] = {3, 1, 2, 3, 2, 6};
    expect_bad(
        &(struct sample){.positions = SPLIT, .n_positions = 10, .indices = bow_tie, .n_indices = 6},
        "part.glb: no face of 1 can be drawn; face 0 (counting from 0) is a face with a vertex at "
        "corners that are no neighbours (a keyhole: split it)");
}

/* Nodes */

static void test_transforms(void **state)
{
    (void)state;
    struct cage cage;
    /* Nodes are transformed in double precision: single precision would lose the quarter beside a
     * hundred million. */
    read_good(&cage, &(struct sample){.nodes = "{\"mesh\":0,\"translation\":[100000000.25,2,3],"
                                               "\"scale\":[2,3,4]}"});
    expect_position(&cage, 5, 100000004.25, 5, 3);
    EXPECT_FACE(&cage, 0, 0, 1, 4, 3);
    cage_finish(&cage);

    /* A quarter turn about z, then the parent's shift. */
    read_good(&cage,
              &(struct sample){
                  .nodes = "{\"children\":[1],\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,10,20,30,1]"
                           "},{\"mesh\":0,\"rotation\":[0,0,0.70710678,0.70710678]}"});
    const double *p = cage.position[2];
    assert_true(fabs(p[0] - 10) < 1e-12 && fabs(p[1] - 22) < 1e-12 && p[2] == 30);
    cage_finish(&cage);

    /* The order is scale, rotation, translation. A matrix is stored column by column. */
    read_good(&cage,
              &(struct sample){.nodes = "{\"mesh\":0,\"scale\":[1,5,1],\"rotation\":[0,0,1,1]"
                                        ",\"translation\":[7,0,0]}"});
    p = cage.position[3];
    assert_true(fabs(p[0] - 2) < 1e-12 && fabs(p[1]) < 1e-12);
    cage_finish(&cage);
    read_good(&cage, &(struct sample){
                         .nodes = "{\"mesh\":0,\"matrix\":[1,2,3,0,4,5,6,0,7,8,10,0,9,9,9,1]}"});
    expect_position(&cage, 4, 14, 16, 18);
    EXPECT_FACE(&cage, 0, 0, 3, 4, 1); /* the determinant of this matrix is -3 */
    cage_finish(&cage);
}

static void test_mirror(void **state)
{
    (void)state;
    struct cage cage;
    read_good(&cage, &(struct sample){.nodes = "{\"mesh\":0,\"scale\":[-1,1,1]}"});
    EXPECT_FACE(&cage, 0, 0, 3, 4, 1);
    EXPECT_FACE(&cage, 1, 1, 4, 5, 2);
    cage_finish(&cage);
    read_good(&cage, &(struct sample){
                         .nodes = "{\"children\":[1],\"scale\":[1,-1,1]},"
                                  "{\"mesh\":0,\"scale\":[-1,1,1]}"}); /* twice: a half turn */
    EXPECT_FACE(&cage, 0, 0, 1, 4, 3);
    cage_finish(&cage);
}

/* Half of a body, and a mirrored instance of that half: they touch at x = 0 and remain two
 * surfaces. */
static void test_instances(void **state)
{
    (void)state;
    struct cage cage;
    read_good(&cage, &(struct sample){.scene = "\"scene\":1,\"scenes\":[{},{\"nodes\":[2,1]}]",
                                      .nodes = "{\"mesh\":7},{\"mesh\":0,\"scale\":[-1,1,1]},"
                                               "{\"mesh\":0}"});
    assert_int_equal(cage.n_faces, 4);
    assert_int_equal(cage.n_vertices, 12);
    EXPECT_FACE(&cage, 0, 0, 1, 4, 3);
    EXPECT_FACE(&cage, 2, 6, 9, 10, 7);
    expect_position(&cage, 7, -1, 0, 0);
    cage_finish(&cage);
}

#define GRID_ACCESSOR "{\"bufferView\":0,\"componentType\":5126,\"type\":\"VEC3\",\"count\":6}"

/* Equal positions are welded within one mesh of one node, across primitives, and nowhere else. */
static void test_bodies(void **state)
{
    (void)state;
    static const char tags[] = "\"extensions\":{\"FB_ngon_encoding\":{}},\"extras\":{"
                               "\"holeIndices\":[1],\"creaseIndices\":[1,4],\"creaseLengths\":[2],"
                               "\"creaseSharpnesses\":[2],\"cornerIndices\":[2],"
                               "\"cornerSharpnesses\":[3]}";
    struct cage cage;
    /* Two nodes show one mesh at the same place. Each instance has the mesh's tags. */
    read_good(&cage, &(struct sample){.scene = "\"scene\":0,\"scenes\":[{\"nodes\":[0,1]}]",
                                      .nodes = "{\"mesh\":0},{\"mesh\":0}",
                                      .primitive = tags});
    assert_int_equal(cage.n_vertices, 12);
    assert_int_equal(cage.n_faces, 4);
    EXPECT_FACE(&cage, 2, 6, 7, 10, 9);
    assert_memory_equal(cage.position[0], cage.position[6], 6 * sizeof *cage.position);
    assert_int_equal(cage.hole[1], 3);
    assert_int_equal(cage.crease[1].vertex[0], 7);
    assert_int_equal(cage.crease[1].vertex[1], 10);
    assert_int_equal(cage.corner[1].vertex, 8);
    cage_finish(&cage);

    /* Two accessors read the same bytes: first in two primitives of one mesh, then in two
     * meshes. */
    static const char accessors[] =
        GRID_ACCESSOR "," GRID_ACCESSOR
                      ",{\"bufferView\":1,\"componentType\":5123,\"type\":\"SCALAR\",\"count\":6},"
                      "{\"bufferView\":1,\"byteOffset\":12,\"componentType\":5123,\"type\":"
                      "\"SCALAR\",\"count\":6}";
#define HALF(positions, indices)                                                                   \
    "{\"attributes\":{\"POSITION\":" positions "},\"indices\":" indices                            \
    ",\"extensions\":{\"FB_ngon_encoding\":{}}}"
    read_good(&cage, &(struct sample){
                         .accessors = accessors,
                         .meshes = "{\"primitives\":[" HALF("0", "2") "," HALF("1", "3") "]}"});
    assert_int_equal(cage.n_vertices, 6);
    EXPECT_FACE(&cage, 1, 1, 2, 5, 4);
    cage_finish(&cage);
    read_good(&cage, &(struct sample){.accessors = accessors,
                                      .nodes = "{\"mesh\":0,\"children\":[1]},{\"mesh\":1}",
                                      .meshes = "{\"primitives\":[" HALF(
                                          "0", "2") "]},"
                                                    "{\"primitives\":[" HALF("1", "3") "]}"});
    assert_int_equal(cage.n_vertices, 12);
    EXPECT_FACE(&cage, 1, 7, 8, 11, 10);
    cage_finish(&cage);
}

static void test_primitives(void **state)
{
    (void)state;
    struct cage cage;
    /* If two primitives use the same accessor, its vertices are read once. Vertices that no face
     * uses cause no error. */
    struct sample sample = {
        .meshes = "{\"primitives\":["
                  "{\"attributes\":{\"POSITION\":0},\"indices\":1,"
                  "\"extras\":{\"holeIndices\":[1]}},"
                  "{\"attributes\":{\"POSITION\":0},\"indices\":2,"
                  "\"extensions\":{\"FB_ngon_encoding\":{}},\"extras\":{\"holeIndices\":[0]}}]}",
        .accessors = "{\"bufferView\":0,\"componentType\":5126,\"type\":\"VEC3\",\"count\":6},"
                     "{\"bufferView\":1,\"componentType\":5123,\"type\":\"SCALAR\",\"count\":6},"
                     "{\"bufferView\":1,\"componentType\":5123,\"type\":\"SCALAR\",\"count\":6,"
                     "\"byteOffset\":12}"};
    read_good(&cage, &sample);
    assert_int_equal(cage.n_vertices, 6);
    assert_int_equal(cage.n_faces, 3);
    EXPECT_FACE(&cage, 2, 1, 2, 5, 4);
    assert_int_equal(cage.hole[0], 1);
    assert_int_equal(cage.hole[1], 2); /* the first face of the second primitive */
    cage_finish(&cage);
}

static void test_index_types(void **state)
{
    (void)state;
    static const struct {
        const char *accessor, *view;
        uint16_t index[6];
    } types[] = {
        {"5121,\"count\":6", "6", {0x0100, 0x0004, 0x0304, 0, 0, 0}},
        {"5125,\"count\":3", "12", {0, 0, 1, 0, 4, 0}},
    };
    for (size_t i = 0; i < 2; i++) {
        char accessors[300], views[200];
        struct cage cage;
        snprintf(accessors, sizeof accessors,
                 "{\"bufferView\":0,\"componentType\":5126,\"type\":\"VEC3\",\"count\":6},"
                 "{\"bufferView\":1,\"type\":\"SCALAR\",\"componentType\":%s}",
                 types[i].accessor);
        snprintf(views, sizeof views,
                 "{\"buffer\":0,\"byteLength\":72},"
                 "{\"buffer\":0,\"byteOffset\":72,\"byteLength\":%s}",
                 types[i].view);
        read_good(&cage, &(struct sample){.accessors = accessors,
                                          .views = views,
                                          .indices = types[i].index,
                                          .n_indices = 6});
        if (i == 0)
            EXPECT_FACE(&cage, 0, 0, 1, 4, 3);
        else
            EXPECT_FACE(&cage, 0, 0, 1, 4);
        cage_finish(&cage);
    }
}

/* Positions interleaved with something else. */
static void test_stride(void **state)
{
    (void)state;
    static const float mixed[] = {0, 0, 0, 9, 1, 0, 0, 9, 1, 1, 0, 9};
    static const uint16_t triangle[] = {0, 1, 2, 0};
    struct cage cage;
    read_good(&cage,
              &(struct sample){
                  .positions = mixed,
                  .n_positions = 4,
                  .indices = triangle,
                  .n_indices = 4,
                  .accessors =
                      "{\"bufferView\":0,\"componentType\":5126,\"type\":\"VEC3\",\"count\":3},"
                      "{\"bufferView\":1,\"componentType\":5123,\"type\":\"SCALAR\",\"count\":3}",
                  .views = "{\"buffer\":0,\"byteLength\":48,\"byteStride\":16},"
                           "{\"buffer\":0,\"byteOffset\":48,\"byteLength\":6}"});
    assert_int_equal(cage.n_vertices, 3);
    expect_position(&cage, 2, 1, 1, 0);
    cage_finish(&cage);
}

static void test_without_a_scene(void **state)
{
    (void)state;
    struct cage cage;
    read_good(&cage, &(struct sample){.scene = "\"scenes\":[]",
                                      .nodes = "{\"mesh\":0,\"translation\":[9,9,9]},"
                                               "{\"children\":[0],\"translation\":[1,0,0]}"});
    assert_int_equal(cage.n_faces, 2);
    expect_position(&cage, 0, 10, 9, 9);
    cage_finish(&cage);
}

/* Our own model, as OBJ and as glTF, gives the same cage. */

static struct cage read_model(const char *path)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        fail_msg("cannot open %s: run the tests from the repository's root", path);
    static char bytes[1 << 20];
    size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    struct cage cage;
    struct error error = {0};
    if (!cage_read(&cage, bytes, size, path, &error))
        fail_msg("%s", error.text);
    return cage;
}

static void test_fender(void **state)
{
    (void)state;
    struct cage obj = read_model("tests/models/fender.obj");
    struct cage gltf = read_model("tests/models/fender.gltf");
    assert_int_equal(gltf.n_vertices, obj.n_vertices);
    assert_int_equal(gltf.n_faces, obj.n_faces);
    assert_memory_equal(gltf.position, obj.position, obj.n_vertices * sizeof *obj.position);
    assert_memory_equal(gltf.face_start, obj.face_start,
                        (obj.n_faces + 1) * sizeof *obj.face_start);
    assert_memory_equal(gltf.face_vertex, obj.face_vertex,
                        obj.face_start[obj.n_faces] * sizeof *obj.face_vertex);
    assert_null(gltf.warnings);
    cage_finish(&obj);
    cage_finish(&gltf);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_quads),           cmocka_unit_test(test_polygons),
        cmocka_unit_test(test_plain_triangles), cmocka_unit_test(test_no_indices),
        cmocka_unit_test(test_broken_polygons), cmocka_unit_test(test_weld),
        cmocka_unit_test(test_collapse),        cmocka_unit_test(test_repeated_corners),
        cmocka_unit_test(test_transforms),      cmocka_unit_test(test_mirror),
        cmocka_unit_test(test_instances),       cmocka_unit_test(test_primitives),
        cmocka_unit_test(test_index_types),     cmocka_unit_test(test_stride),
        cmocka_unit_test(test_without_a_scene), cmocka_unit_test(test_bodies),
        cmocka_unit_test(test_fender),
    };
    return cmocka_run_group_tests_name("cage/gltf", tests, NULL, NULL);
}
