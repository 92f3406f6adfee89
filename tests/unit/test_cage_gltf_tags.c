/* Subdivision tags in glTF's extras. */
#include "tests/unit/gltf_sample.h"

#define TAGGED(tags) "\"extensions\":{\"FB_ngon_encoding\":{}},\"extras\":{" tags "}"

static void expect_crease(const struct cage *cage, size_t i, uint32_t a, uint32_t b, float sharp)
{
    assert_true(i < cage->n_creases);
    assert_int_equal(cage->crease[i].vertex[0], a);
    assert_int_equal(cage->crease[i].vertex[1], b);
    assert_true(cage->crease[i].sharpness == sharp);
}

static void test_creases(void **state)
{
    (void)state;
    struct cage cage;
    /* creaseSharpnesses has one value for each crease. */
    read_good(&cage, &(struct sample){.primitive = TAGGED("\"creaseIndices\":[0,1,2,4,1],"
                                                          "\"creaseLengths\":[3,2],"
                                                          "\"creaseSharpnesses\":[2.5,10]")});
    assert_int_equal(cage.n_creases, 3);
    expect_crease(&cage, 0, 0, 1, 2.5f);
    expect_crease(&cage, 1, 1, 2, 2.5f);
    expect_crease(&cage, 2, 4, 1, 10);
    cage_finish(&cage);
    /* creaseSharpnesses has one value for each edge. A negative value counts as smooth. Integers
     * may be written with a decimal point. */
    read_good(&cage, &(struct sample){.primitive = TAGGED("\"creaseIndices\":[0,1.0,2,4,1],"
                                                          "\"creaseLengths\":[3,2],"
                                                          "\"creaseSharpnesses\":[1,-2,3]")});
    expect_crease(&cage, 0, 0, 1, 1);
    expect_crease(&cage, 1, 1, 2, 0);
    assert_string_equal(cage.warnings, "part.glb: mesh 0 primitive 0: creaseSharpnesses[1] is -2 "
                                       "and counts as 0, as any other below 0");
    expect_crease(&cage, 2, 4, 1, 3);
    cage_finish(&cage);
    /* The tags are in the mesh's extras, in an object named subdiv. */
    read_good(&cage, &(struct sample){.mesh = ",\"extras\":{\"subdiv\":{\"creaseIndices\":[1,4],"
                                              "\"creaseLengths\":[2],\"creaseSharpnesses\":[7]}}"});
    expect_crease(&cage, 0, 1, 4, 7);
    cage_finish(&cage);
    /* Each instance of a mesh has the mesh's tags. */
    read_good(&cage, &(struct sample){.scene = "\"scenes\":[{\"nodes\":[0,1]}]",
                                      .nodes = "{\"mesh\":0},{\"mesh\":0,\"translation\":[0,0,1]}",
                                      .primitive = TAGGED("\"creaseIndices\":[1,4],"
                                                          "\"creaseLengths\":[2],"
                                                          "\"creaseSharpnesses\":[7],"
                                                          "\"holeIndices\":[1]")});
    expect_crease(&cage, 1, 7, 10, 7);
    assert_int_equal(cage.hole[1], 3);
    cage_finish(&cage);
}

static void test_settings(void **state)
{
    (void)state;
    struct cage cage;
    read_good(&cage,
              &(struct sample){.primitive = TAGGED("\"interpolateBoundary\":\"edgeAndCorner\","
                                                   "\"subdivisionScheme\":\"bilinear\","
                                                   "\"triangleSubdivisionRule\":\"smooth\","
                                                   "\"cornerIndices\":[5,0],"
                                                   "\"cornerSharpnesses\":[1,2],"
                                                   "\"holeIndices\":[1],\"comment\":[1,\"x\"]")});
    assert_int_equal(cage.boundary, CAGE_BOUNDARY_EDGE_AND_CORNER);
    assert_int_equal(cage.scheme, CAGE_SCHEME_BILINEAR);
    assert_true(cage.smooth_triangles);
    assert_int_equal(cage.n_corners, 2);
    assert_int_equal(cage.corner[0].vertex, 5);
    assert_true(cage.corner[1].sharpness == 2);
    assert_int_equal(cage.n_holes, 1);
    assert_int_equal(cage.hole[0], 1);
    cage_finish(&cage);
    read_good(&cage, &(struct sample){.primitive = TAGGED("\"interpolateBoundary\":\"none\"")});
    assert_int_equal(cage.boundary, CAGE_BOUNDARY_NONE);
    cage_finish(&cage);
    read_good(&cage, &(struct sample){.primitive =
                                          TAGGED("\"interpolateBoundary\":\"edgeOnly\","
                                                 "\"subdivisionScheme\":\"catmullClark\","
                                                 "\"triangleSubdivisionRule\":\"catmullClark\"")});
    assert_int_equal(cage.boundary, CAGE_BOUNDARY_EDGE_ONLY);
    assert_int_equal(cage.scheme, CAGE_SCHEME_CATMULL_CLARK);
    assert_false(cage.smooth_triangles);
    cage_finish(&cage);
}

static void test_tag_errors(void **state)
{
    (void)state;
    static const struct {
        const char *primitive, *message;
    } bad[] = {
        {TAGGED("\"creaseIndices\":[1,6],\"creaseLengths\":[2],\"creaseSharpnesses\":[1]"),
         "creaseIndices[1] is 6, but the primitive has 6 vertices"},
        {TAGGED("\"creaseIndices\":[1,-4],\"creaseLengths\":[2],\"creaseSharpnesses\":[1]"),
         "creaseIndices[1] is not an index"},
        {TAGGED("\"creaseIndices\":[1.5,4],\"creaseLengths\":[2],\"creaseSharpnesses\":[1]"),
         "creaseIndices[0] is not an index"},
        {TAGGED("\"creaseIndices\":[1,\"4\"],\"creaseLengths\":[2],\"creaseSharpnesses\":[1]"),
         "creaseIndices[1] is not an index"},
        {TAGGED("\"creaseIndices\":7,\"creaseLengths\":[2],\"creaseSharpnesses\":[1]"),
         "creaseIndices is not an array"},
        {TAGGED("\"creaseIndices\":[1,4],\"creaseSharpnesses\":[1]"),
         "creaseLengths add up to 0, but creaseIndices has 2"},
        {TAGGED("\"creaseIndices\":[0,1,4],\"creaseLengths\":[2],\"creaseSharpnesses\":[1]"),
         "creaseLengths add up to 2, but creaseIndices has 3"},
        {TAGGED("\"creaseIndices\":[0,1,4],\"creaseLengths\":[2,1],\"creaseSharpnesses\":[1]"),
         "creaseLengths[1] is 1, a crease has at least 2 vertices"},
        {TAGGED("\"creaseIndices\":[0,1],\"creaseLengths\":[2147483647],"
                "\"creaseSharpnesses\":[1]"),
         "creaseLengths[0] is 2147483647, but the primitive has 3 crease indices"},
        {TAGGED("\"creaseIndices\":[1,4],\"creaseLengths\":[2]"),
         "0 creaseSharpnesses for 1 creases of 1 edges: give one for each"},
        {TAGGED("\"creaseIndices\":[0,1,2,5],\"creaseLengths\":[4],\"creaseSharpnesses\":[1,2]"),
         "2 creaseSharpnesses for 1 creases of 3 edges: give one for each"},
        {TAGGED("\"creaseIndices\":[1,4],\"creaseLengths\":[2],\"creaseSharpnesses\":[\"x\"]"),
         "creaseSharpnesses[0] is not a finite number"},
        {TAGGED("\"creaseIndices\":[1,4],\"creaseLengths\":[2],\"creaseSharpnesses\":[1e300]"),
         "creaseSharpnesses[0] is not a finite number"},
        {TAGGED("\"cornerIndices\":[1,4],\"cornerSharpnesses\":[2]"),
         "1 cornerSharpnesses for 2 cornerIndices"},
        {TAGGED("\"cornerIndices\":[99],\"cornerSharpnesses\":[2]"),
         "cornerIndices[0] is 99, but the primitive has 6 vertices"},
        {TAGGED("\"holeIndices\":[2]"), "holeIndices[0] is 2, but the primitive has 2 faces"},
        {TAGGED("\"interpolateBoundary\":\"edgeandcorner\""),
         "interpolateBoundary is 'edgeandcorner', needs one of edgeOnly, edgeAndCorner, none"},
        {TAGGED("\"interpolateBoundary\":1"),
         "interpolateBoundary is '', needs one of edgeOnly, edgeAndCorner, none"},
        {TAGGED("\"subdivisionScheme\":\"none\""),
         "subdivisionScheme is 'none', needs one of catmullClark, loop, bilinear"},
        {TAGGED("\"triangleSubdivisionRule\":\"rough\""),
         "triangleSubdivisionRule is 'rough', needs one of catmullClark, smooth"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char message[200];
        snprintf(message, sizeof message, "part.glb: mesh 0 primitive 0: %s", bad[i].message);
        expect_bad(&(struct sample){.primitive = bad[i].primitive}, message);
    }
}

static void test_crease_on_no_edge(void **state)
{
    (void)state;
    struct cage cage;
    read_good(&cage, &(struct sample){.primitive = TAGGED("\"creaseIndices\":[0,4,0,1],"
                                                          "\"creaseLengths\":[2,2],"
                                                          "\"creaseSharpnesses\":[1,2]")});
    assert_int_equal(cage.n_creases, 1);
    assert_int_equal(cage.crease[0].vertex[1], 1);
    assert_true(cage.crease[0].sharpness == 2);
    assert_string_equal(cage.warnings,
                        "part.glb: a crease whose vertices share no edge is ignored");
    cage_finish(&cage);
}

static void test_tags_of_several_primitives(void **state)
{
    (void)state;
#define TWO(first, second, mesh)                                                                   \
    "{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1" first "},"                   \
    "{\"attributes\":{\"POSITION\":0},\"indices\":1" second "}]" mesh "}"
    struct cage cage;
    read_good(&cage,
              &(struct sample){.meshes = TWO(",\"extras\":{\"interpolateBoundary\":\"none\"}", "",
                                             ",\"extras\":{\"interpolateBoundary\":\"none\"}")});
    assert_int_equal(cage.boundary, CAGE_BOUNDARY_NONE);
    cage_finish(&cage);
    expect_bad(
        &(struct sample){.meshes = TWO(",\"extras\":{\"interpolateBoundary\":\"none\"}",
                                       ",\"extras\":{\"interpolateBoundary\":\"edgeOnly\"}", "")},
        "part.glb: mesh 0 primitive 1: interpolateBoundary differs from another "
        "primitive's, but a cage has only one");
    expect_bad(&(struct sample){.meshes = TWO("", "", ",\"extras\":{\"holeIndices\":[0]}")},
               "part.glb: mesh 0 primitive 0: the mesh's extras hold crease, corner or hole "
               "indices, but it has 2 primitives: put them into each primitive's extras");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_creases),
        cmocka_unit_test(test_settings),
        cmocka_unit_test(test_tag_errors),
        cmocka_unit_test(test_crease_on_no_edge),
        cmocka_unit_test(test_tags_of_several_primitives),
    };
    return cmocka_run_group_tests_name("cage/gltf_tags", tests, NULL, NULL);
}
