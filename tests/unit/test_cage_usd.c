/* The USD reader: what it takes from a layer, and what it passes over with a warning. */
#include <stdio.h>

#include "tests/unit/usd_sample.h"

#define PLACED(ops) USD "def Xform \"a\" {\n" ops "def Mesh \"m\" {\n" USD_PAIR "}}\n"

static void expect_warning(const struct cage *cage, const char *warning)
{
    assert_non_null(cage->warnings);
    assert_string_equal(cage->warnings, warning);
}

static void expect_pair(const struct cage *cage)
{
    assert_int_equal(cage->n_vertices, 6);
    assert_int_equal(cage->n_faces, 2);
    EXPECT_FACE(cage, 0, 0, 1, 4, 3);
    EXPECT_FACE(cage, 1, 1, 2, 5, 4);
    assert_true(cage->position[5][0] == 2 && cage->position[5][1] == 1);
}

/* The forms that the same two quads may have. */
static void test_forms(void **state)
{
    (void)state;
    static const char *const texts[] = {
        USD USD_MESH(USD_PAIR),
        "\xef\xbb\xbf" USD USD_MESH(USD_PAIR),
        "#sdf 1.4.32\n" USD_MESH(USD_PAIR),
        /* Line endings, separators, comments, commas after the last element. */
        "#usda 1.0\r\n# a\r\n// b\r\n/* c\r\n */def Mesh \"m\"\r\n(\r\n)\r\n{point3f[] "
        "points=[(0,0,0,),"
        "(1,0,0),(2,0,0),(0,1,0),\r\n(1,1,0),(2,1,0),];int[] faceVertexCounts=[4,4,];int[]\r\n"
        "faceVertexIndices\t=\t[0,1,4,3,1,2,5,4]}",
        /* Old types, numbers of other forms, texts and paths with signs in them. */
        USD "( \"a } ( \" doc = '''b\n\"'''\n customLayerData = { dictionary d = { int[] x = [1] } "
            "}\n )\n"
            "def Mesh \"m }\" ( kind = 'x' customData = { string s = \"\\\"}\" } )\n{\n"
            "PointFloat[] points = [(0,+0,-0),(1.,0,0),(20e-1,0,0),(0,.1e1,0),(1,1,0),(2,1,0)]\n"
            "int[] faceVertexCounts = [4, 4]\nint[] faceVertexIndices = [0,1,4,3,1,2,5,4]\n"
            "asset a = @./}.png@ ( doc = \"(\" )\nasset b = @@@}@x\\@@@ [@@@@\nrel r = </a/b.c>\n"
            "add rel s = [</a>, </b>]\ncustom token t.connect = </a.b>\nfloat unset\n"
            "uniform token[] u = None\ncolor3f[] primvars:displayColor = [(1, 0, 0)] ( "
            "interpolation = \"constant\" )\nfloat f.timeSamples = { 1: 2, -3: None, }\n"
            "double d.spline = { bezier, 0: 1 & 2; pre (8, -0); post held, }\ntoken visibility = "
            "\"visible\"\n"
            "reorder properties = [\"a\"]\nint[] primvars:st:indices = []\n}\n"
            "reorder rootPrims = [\"m\"]\n",
        /* A value counts before samples, samples before None, and the later value. */
        USD USD_MESH(
            "point3f[] points.timeSamples = { 1: [(9,9,9)] }\npoint3f[] points = [(7,7,7)]\n"
            "int[] holeIndices = None\n" USD_PAIR
            "point3f[] points.timeSamples = { 1: [(9,9,9)] }\n"),
        /* Prims without a type or of a type that nobody knows, and deeply nested. */
        USD "def \"a\" { def Scope \"b\" { def Xform \"c\" { def SomethingNew \"d\" {\n" USD_MESH(
            USD_PAIR) "}}}}",
        /* Metadata that takes nothing from elsewhere. */
        USD "def Mesh \"m\" ( references = None payload = [] delete inherits = </a> instanceable = "
            "true\n"
            "prepend apiSchemas = [\"MaterialBindingAPI\"] active = true ) {\n" USD_PAIR "}\n",
        /* A material may take what it likes from elsewhere. */
        USD "def Material \"k\" ( references = @a.usd@ ) { def Shader \"s\" ( payload = @b@ ) {} "
            "}\n" USD_MESH(USD_PAIR),
    };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        struct cage cage;
        read_usd(&cage, texts[i]);
        expect_pair(&cage);
        assert_null(cage.warnings);
        assert_int_equal(cage.up, CAGE_UP_Y);
        assert_int_equal(cage.scheme, CAGE_SCHEME_CATMULL_CLARK);
        assert_int_equal(cage.boundary, CAGE_BOUNDARY_EDGE_AND_CORNER);
        assert_false(cage.smooth_triangles || cage.chaikin);
        cage_finish(&cage);
    }
}

/* The content tells USD only if the name does not tell another format. */
static void test_format(void **state)
{
    (void)state;
    static const char *const names[] = {"part.usda", "PART.USDA", "part.usd", "part", "part.txt"};
    static const char text[] = USD USD_MESH(USD_PAIR);
    struct cage cage;
    struct error error = {0};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        read_bytes(&cage, text, strlen(text), names[i]);
        expect_pair(&cage);
        cage_finish(&cage);
    }
    assert_false(cage_read(&cage, text, strlen(text), "part.obj", &error));
    assert_int_equal(error.kind, ERROR_MODEL);
}

static void test_settings(void **state)
{
    (void)state;
    struct cage cage;
    read_usd(&cage, USD "( upAxis = \"Z\" metersPerUnit = 0.001 )\n" USD_MESH(
                        USD_PAIR "uniform token interpolateBoundary = \"none\"\n"
                                 "uniform token triangleSubdivisionRule = \"smooth\"\n"
                                 "uniform token subdivisionScheme = \"loop\"\n"
                                 "int[] holeIndices = [1]\nint[] cornerIndices = [0, 5]\n"
                                 "float[] cornerSharpnesses = [inf, 2.5]\n"));
    assert_int_equal(cage.up, CAGE_UP_Z);
    assert_int_equal(cage.boundary, CAGE_BOUNDARY_NONE);
    assert_int_equal(cage.scheme, CAGE_SCHEME_LOOP);
    assert_true(cage.smooth_triangles);
    assert_int_equal(cage.n_holes, 1);
    assert_int_equal(cage.hole[0], 1);
    assert_int_equal(cage.n_corners, 2);
    assert_true(cage.corner[0].vertex == 0 && cage.corner[0].sharpness == CAGE_SHARPNESS_INFINITE);
    assert_true(cage.corner[1].vertex == 5 && cage.corner[1].sharpness == 2.5f);
    cage_finish(&cage);
}

/* A left-handed mesh and a mirroring transform each turn the faces, but keep their first corners. */
static void test_orientation(void **state)
{
    (void)state;
#define LEFT "uniform token orientation = \"leftHanded\"\n"
#define MIRROR                                                                                     \
    "float3 xformOp:scale = (1,1,-1)\nuniform token[] xformOpOrder = [\"xformOp:scale\"]\n"
    static const struct {
        const char *text;
        bool turned;
    } cases[] = {{USD USD_MESH(USD_PAIR), false},
                 {USD USD_MESH(USD_PAIR LEFT), true},
                 {USD USD_MESH(USD_PAIR MIRROR), true},
                 {USD USD_MESH(USD_PAIR LEFT MIRROR), false}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct cage cage;
        read_usd(&cage, cases[i].text);
        if (cases[i].turned)
            EXPECT_FACE(&cage, 0, 0, 3, 4, 1);
        else
            EXPECT_FACE(&cage, 0, 0, 1, 4, 3);
        cage_finish(&cage);
    }
}

/* One sharpness for each edge, or for each crease of several edges. */
static void test_creases(void **state)
{
    (void)state;
    static const struct {
        const char *sharpnesses;
        float expected[3];
    } cases[] = {{"[1, 2, 3]", {1, 2, 3}}, {"[1.5, -4]", {1.5f, 0, 0}}};
    for (size_t i = 0; i < 2; i++) {
        char text[600];
        struct cage cage;
        snprintf(text, sizeof text,
                 USD "def Mesh \"m\" {\n" USD_PAIR
                     "int[] creaseIndices = [0, 1, 1, 4, 3]\nint[] creaseLengths = [2, 3]\n"
                     "float[] creaseSharpnesses = %s\n}\n",
                 cases[i].sharpnesses);
        static const uint32_t ends[3][2] = {{0, 1}, {1, 4}, {4, 3}};
        read_usd(&cage, text);
        assert_int_equal(cage.n_creases, 3);
        for (size_t c = 0; c < 3; c++) {
            assert_memory_equal(cage.crease[c].vertex, ends[c], sizeof ends[c]);
            assert_true(cage.crease[c].sharpness == cases[i].expected[c]);
        }
        if (i == 1)
            expect_warning(&cage, "part.usda: a sharpness below 0 counts as 0");
        cage_finish(&cage);
    }
}

/* Tags of elements that do not exist cost one warning of each kind, with the line. */
static void test_damaged_tags(void **state)
{
    (void)state;
    struct cage cage;
    read_usd(&cage,
             USD USD_MESH(USD_PAIR "int[] creaseIndices = [0, 6,\n -1, 1,\n 1, 4]\n"
                                   "int[] creaseLengths = [2, 2, 2]\n"
                                   "float[] creaseSharpnesses = [1, 1, 1]\n"
                                   "int[] cornerIndices = [6]\nfloat[] cornerSharpnesses = [3]\n"
                                   "int[] holeIndices = [2, -9]\n"));
    expect_pair(&cage);
    assert_true(cage.n_creases == 1 && cage.n_corners == 0 && cage.n_holes == 0);
    expect_warning(
        &cage, "part.usda:6: a crease whose vertices share no edge is ignored; 2 in all, this is "
               "the first\n"
               "part.usda:11: a corner tag of a vertex that does not exist is ignored\n"
               "part.usda:13: a hole of a face that does not exist is ignored; 2 in all, this is "
               "the first");
    cage_finish(&cage);
}

/* Bodies stay apart, each with tags of its own, even where their positions are equal. */
static void test_bodies(void **state)
{
    (void)state;
    struct cage cage;
    read_usd(&cage, USD USD_MESH(USD_PAIR "int[] holeIndices = [1]\n")
                        USD_MESH(USD_PAIR "int[] holeIndices = [0]\nint[] cornerIndices = [0]\n"
                                          "float[] cornerSharpnesses = [4]\n"));
    assert_int_equal(cage.n_vertices, 12);
    EXPECT_FACE(&cage, 2, 6, 7, 10, 9);
    assert_true(cage.n_holes == 2 && cage.hole[0] == 1 && cage.hole[1] == 2);
    assert_true(cage.n_corners == 1 && cage.corner[0].vertex == 6);
    cage_finish(&cage);
}

/* Meshes with different boundaries: corners get tags where only their mesh makes them sharp. */
static void test_mixed_boundaries(void **state)
{
    (void)state;
    struct cage cage;
    read_usd(&cage, USD USD_MESH(USD_PAIR "uniform token interpolateBoundary = \"edgeOnly\"\n")
                        USD_MESH(USD_PAIR "int[] cornerIndices = [3]\n"
                                          "float[] cornerSharpnesses = [1]\n"));
    assert_int_equal(cage.boundary, CAGE_BOUNDARY_EDGE_ONLY);
    static const uint32_t tagged[] = {9, 6, 8, 9, 11};
    assert_int_equal(cage.n_corners, 5);
    for (size_t i = 0; i < 5; i++) {
        assert_int_equal(cage.corner[i].vertex, tagged[i]);
        assert_true(cage.corner[i].sharpness == (i ? CAGE_SHARPNESS_INFINITE : 1));
    }
    cage_finish(&cage);
}

/* The rule of triangles matters to meshes that have triangles. */
static void test_triangle_rules(void **state)
{
    (void)state;
#define TRIANGLE                                                                                   \
    "point3f[] points = [(0,0,0),(1,0,0),(0,1,0)]\nint[] faceVertexCounts = [3]\n"                 \
    "int[] faceVertexIndices = [0,1,2]\n"
#define SMOOTH "uniform token triangleSubdivisionRule = \"smooth\"\n"
    static const struct {
        const char *text;
        bool smooth;
    } cases[] = {{USD USD_MESH(TRIANGLE SMOOTH) USD_MESH(USD_PAIR), true},
                 {USD USD_MESH(USD_PAIR SMOOTH) USD_MESH(TRIANGLE), false},
                 {USD USD_MESH(TRIANGLE) USD_MESH(USD_PAIR SMOOTH), false},
                 {USD USD_MESH(USD_PAIR) USD_MESH(TRIANGLE SMOOTH), true}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct cage cage;
        read_usd(&cage, cases[i].text);
        assert_int_equal(cage.smooth_triangles, cases[i].smooth);
        cage_finish(&cage);
    }
}

/* What is passed over, and the warning. */
static void test_passed_over(void **state)
{
    (void)state;
    static const struct {
        const char *text, *warning;
    } cases[] = {
        {USD "over \"a\" { def Mesh \"x\" {} }\nclass Mesh \"b\" {}\ndef Mesh \"c\" (active = "
             "false) {}\n" USD_MESH(USD_PAIR),
         "part.usda: meshes in prims that are inactive, over or class are passed over: 3"},
        {USD
         "def Xform \"a\" { token visibility = \"invisible\"\ndef Mesh \"x\" ( payload = @a@ ) {}\n"
         "def Mesh \"y\" {} }\n" USD_MESH(USD_PAIR),
         "part.usda:3: invisible meshes are passed over: 2, the first is 'x'"},
        /* A purpose holds below, until another is given. */
        {USD "def Xform \"a\" { uniform token purpose = \"proxy\"\ndef Mesh \"x\" { }\n"
             "def Mesh \"y\" { uniform token purpose = \"render\"\n" USD_PAIR "}}\n",
         "part.usda:3: meshes of purpose guide or proxy are passed over: 'x'"},
        {USD "def Sphere \"a\" { double radius = 1 }\ndef NurbsPatch \"b\" {}\n" USD_MESH(USD_PAIR),
         "part.usda:2: geometry that is no Mesh is passed over: 2, the first is 'a'"},
        {USD "def Mesh \"a\" { point3f[] points = []\n}\n" USD_MESH(USD_PAIR),
         "part.usda:2: meshes without points or faces are passed over: 'a'"},
        {USD "def SkelRoot \"a\" {\n" USD_MESH(USD_PAIR) "}\n",
         "part.usda:2: skins are passed over, the cage stands in its bind pose: 'a'"},
        {USD "def Scope \"a\" { uniform token[] xformOpOrder = [\"xformOp:scale\"]\n"
             "float3 xformOp:scale = (9,9,9)\n" USD_MESH(USD_PAIR) "}\n",
         "part.usda:2: xformOpOrder has no effect on a prim without a type and on a Scope: 'a'"},
        {USD USD_MESH(USD_PAIR "uniform token[] xformOpOrder = [\"xformOp:scale\"]\n"),
         "part.usda:6: entries of xformOpOrder without a property are passed over: "
         "'xformOp:scale'"},
        {USD "def Mesh \"m\" {\nint[] faceVertexCounts.timeSamples = { 2: [3], 1: [4,4], 3: [] }\n"
             "point3f[] points = [(0,0,0),(1,0,0),(2,0,0),(0,1,0),(1,1,0),(2,1,0)]\n"
             "int[] faceVertexIndices = [0,1,4,3, 1,2,5,4]\n}\n",
         "part.usda:3: properties vary over time, and the earliest time is shown: "
         "'faceVertexCounts'"},
        /* The place of a mesh varies if an op of a parent does, unless a reset drops it. */
        {USD "def Xform \"a\" {\ndouble xformOp:rotateX.timeSamples = { 1: 360 }\n"
             "uniform token[] xformOpOrder = [\"xformOp:rotateX\"]\n" USD_MESH(USD_PAIR) "}\n",
         "part.usda:3: properties vary over time, and the earliest time is shown: "
         "'xformOp:rotateX'"},
        {USD "def Xform \"a\" {\ndouble xformOp:rotateX.timeSamples = { 1: 30 }\n"
             "uniform token[] xformOpOrder = [\"xformOp:rotateX\"]\n"
             "def Mesh \"x\" {}\n" USD_MESH(
                 USD_PAIR "uniform token[] xformOpOrder = [\"!resetXformStack!\"]\n") "}\n",
         "part.usda:3: properties vary over time, and the earliest time is shown: "
         "'xformOp:rotateX'\n"
         "part.usda:5: meshes without points or faces are passed over: 'x'"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct cage cage;
        read_usd(&cage, cases[i].text);
        expect_pair(&cage);
        expect_warning(&cage, cases[i].warning);
        cage_finish(&cage);
    }
}

static void expect_corner(const char *text, double x, double y, double z)
{
    struct cage cage;
    read_usd(&cage, text);
    if (cage.position[5][0] != x || cage.position[5][1] != y || cage.position[5][2] != z)
        fail_msg("%g %g %g: %s", cage.position[5][0], cage.position[5][1], cage.position[5][2],
                 text);
    cage_finish(&cage);
}

/* Where the corner (2, 1, 0) comes to: exactly, because quarter turns are exact. */
static void test_places(void **state)
{
    (void)state;
#define ORDER(names) "uniform token[] xformOpOrder = [" names "]\n"
#define T "double3 xformOp:translate = (10,20,30)\n"
#define RZ "float xformOp:rotateZ = 90\n"
    expect_corner(PLACED(T), 2, 1, 0); /* without xformOpOrder it has no effect */
    expect_corner(PLACED(T ORDER("\"xformOp:translate\"")), 12, 21, 30);
    expect_corner(PLACED(RZ ORDER("\"xformOp:rotateZ\"")), -1, 2, 0);
    expect_corner(PLACED(RZ ORDER("\"!invert!xformOp:rotateZ\"")), 1, -2, 0);
    /* The first op is the outermost. */
    expect_corner(PLACED(T RZ ORDER("\"xformOp:translate\", \"xformOp:rotateZ\"")), 9, 22, 30);
    expect_corner(PLACED(T RZ ORDER("\"xformOp:rotateZ\", \"xformOp:translate\"")), -21, 12, 30);
    /* About a pivot. */
    expect_corner(PLACED("float3 xformOp:translate:pivot = (1,0,0)\n" RZ ORDER(
                      "\"xformOp:translate:pivot\", \"xformOp:rotateZ\", "
                      "\"!invert!xformOp:translate:pivot\"")),
                  0, 1, 0);
    /* X first, then Y, then Z: (2,1,0) -> (2,0,1) -> (1,0,-2) -> (0,1,-2). */
    expect_corner(PLACED("float3 xformOp:rotateXYZ = (90,90,90)\n" ORDER("\"xformOp:rotateXYZ\"")),
                  0, 1, -2);
    /* The real part of a quaternion is first. */
    expect_corner(PLACED("quatf xformOp:orient = (0,0,0,3)\n" ORDER("\"xformOp:orient\"")), -2, -1,
                  0);
    /* A matrix is for points as rows. */
    expect_corner(
        PLACED(
            "matrix4d xformOp:transform = ( (0,1,0,0), (-1,0,0,0), (0,0,1,0), (5,6,7,1) )\n" ORDER(
                "\"xformOp:transform\"")),
        4, 8, 7);
    /* Rounding in its last column is passed over. */
    expect_corner(PLACED("matrix4d xformOp:transform = ( (1,0,0,1e-17), (0,1,0,0), (0,0,1,0), "
                         "(1,1,1,0.9999999999999998) )\n" ORDER("\"xformOp:transform\"")),
                  3, 2, 1);
    expect_corner(PLACED("double xformOp:translateY = 3\ndouble xformOp:scaleX:a = 4\n" ORDER(
                      "\"xformOp:scaleX:a\", \"xformOp:translateY\"")),
                  8, 4, 0);
    /* A reset drops parents and what stands before it. */
    expect_corner(USD "def Xform \"a\" {\n" T ORDER("\"xformOp:translate\"")
                      USD_MESH(USD_PAIR "double3 xformOp:scale = (2,2,2)\n" T ORDER(
                          "\"xformOp:translate\", \"!resetXformStack!\", \"xformOp:scale\"")) "}\n",
                  4, 2, 0);
    /* A transform after the child, and an op that varies. */
    expect_corner(USD "def Xform \"a\" {\n" USD_MESH(
                      USD_PAIR) "double3 xformOp:translate.timeSamples = { 1: "
                                "(1,1,1), 0: (10,20,30) }\n" ORDER("\"xformOp:translate\"") "}\n",
                  12, 21, 30);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_forms),          cmocka_unit_test(test_format),
        cmocka_unit_test(test_settings),       cmocka_unit_test(test_orientation),
        cmocka_unit_test(test_creases),        cmocka_unit_test(test_damaged_tags),
        cmocka_unit_test(test_bodies),         cmocka_unit_test(test_mixed_boundaries),
        cmocka_unit_test(test_triangle_rules), cmocka_unit_test(test_passed_over),
        cmocka_unit_test(test_places),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
