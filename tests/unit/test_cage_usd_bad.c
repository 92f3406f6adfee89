/* Damaged USD files, and files that sheen does not read: each is refused with one clear line. */
#include <stdio.h>

#include "tests/unit/usd_sample.h"

#define Q3 "point3f[] points = [(0,0,0),(1,0,0),(0,1,0)]\n"
#define MESH_OF(lines) USD USD_MESH(lines)
/* Five lines, then more of the same mesh from line 6 on. */
#define PAIR_AND(lines) USD USD_MESH(USD_PAIR lines)
#define AT(line) "part.usda:" #line ": "
#define FLATTEN ", which is not read: write a file of its own by usdcat --flatten"

static const struct {
    const char *text, *message;
} BAD[] = {
    /* What the file is */
    {"", "part.usda: the file is empty"},
    {" ", AT(1) "is not a USD text file: it does not begin with #usda 1.0; OBJ, glTF and GLB need "
                "a name that ends in .obj, .gltf or .glb"},
    {"v 0 0 0\n", AT(1) "is not a USD text file: it does not begin with #usda 1.0; OBJ, glTF and "
                        "GLB need a name that ends in .obj, .gltf or .glb"},
    {"#usda 2.0\n", AT(1) "the file's version of USD is not read; #usda 1.0 is"},
    {"PXR-USDC\x01", "part.usda: is USD's binary form, and the text form is read: convert it by "
                     "usdcat --flatten -o FILE.usda"},
    {"PK\3\4", "part.usda: is a package (.usdz), and USD's text form is read: convert it by usdcat "
               "--flatten -o FILE.usda"},
    {USD, "part.usda: it has no prim of type Mesh, so it makes no surface"},
    {USD "def Xform \"a\" {}\n", "part.usda: it has no prim of type Mesh, so it makes no surface"},
    /* Tokens */
    {USD "def Mesh \"m", AT(2) "the string that begins here does not end"},
    {USD "def Mesh \"m\n\" {}", AT(2) "the string that begins here does not end"},
    {USD "def Mesh \"m\" ( doc = \"\"\"a\n\n", AT(2) "the string that begins here does not end"},
    {USD "def Mesh \"m\\\"", AT(2) "the string that begins here does not end"},
    {USD "\n/* def\n", AT(3) "the comment that begins here does not end"},
    {MESH_OF("asset a = @b\n"), AT(3) "the name of a file that begins here does not end"},
    {MESH_OF("rel a = </b\n"), AT(3) "the path that begins here does not end"},
    {USD "def Mesh \"m\" {\n\x01}", AT(3) "byte 0x01 is none of a USD text file"},
    {USD "def Mesh $", AT(2) "'$' stands where USD has no such character"},
    /* Prims and properties */
    {USD "mesh \"m\" {}", AT(2) "'mesh' stands where def, over or class must"},
    {USD "}", AT(2) "'}' stands where def, over or class must"},
    {USD "def", AT(2) "the file ends within a prim's header"},
    {USD "def Mesh {}", AT(2) "def needs a name in quotes, not '{'"},
    {USD "def Mesh \"m\"\nint a", AT(3) "'int' stands where '{' must follow the header of a prim"},
    {USD "def Mesh \"m\"", AT(2) "the file ends where '{' must follow the header of a prim"},
    {USD "def Mesh \"m\" {\n\n", AT(4) "the file ends within 1 open prim: is it cut off?"},
    {USD "def Mesh \"m\" (\n", AT(3) "the file ends within '(', which is not closed"},
    {USD "def Mesh \"m\" ( = 3 )", AT(2) "'=' stands where a word of metadata must"},
    {USD "def Mesh \"m\" ( kind 3 )", AT(2) "'3' stands where '=' must follow a word of metadata"},
    {MESH_OF("3 = 4\n"), AT(3) "'3' stands where a property or a prim must"},
    {MESH_OF("int[3] a = 4\n"), AT(3) "'3' stands where ']' must follow the '[' of a type"},
    {MESH_OF("int = 4\n"), AT(3) "'int' needs the name of a property, not '='"},
    {MESH_OF("int a =\n"), AT(4) "'}' stands where a value must follow"},
    {MESH_OF("int a = [1, (2]\n"), AT(3) "']' stands where ')' must close a bracket"},
    {USD "def Mesh \"m\" {\nint[] a = [1,\n", AT(3) "'[' is not closed"},
    {USD "def Mesh \"m\" {\nint a = ", AT(3) "the file ends where a value must follow"},
    {MESH_OF("variantSet 3\n"), AT(3) "variantSet needs a word in quotes, not '3'"},
    {MESH_OF("point3f[] points.timeSamples = [1]\n"),
     AT(3) "'[' stands where '{' must follow .timeSamples ="},
    {MESH_OF("point3f[] points.timeSamples = { a : [] }\n"),
     AT(3) "a time of timeSamples needs a number, not 'a'"},
    {MESH_OF("point3f[] points.timeSamples = { 1 [] }\n"),
     AT(3) "'[' stands where ':' must follow a time of timeSamples"},
    /* Points */
    {MESH_OF("point3f[] points = [(0,0)]\nint[] faceVertexCounts = [3]\nint[] faceVertexIndices = "
             "[0]\n"),
     AT(3) "a point has 2 numbers, needs 3"},
    {MESH_OF("point3f[] points = [(0,0,0,0)]\nint[] faceVertexCounts = [3]\nint[] "
             "faceVertexIndices = [0]\n"),
     AT(3) "a point has more than 3 numbers"},
    {MESH_OF("point3f[] points = [0,0,0]\nint[] faceVertexCounts = [3]\nint[] faceVertexIndices = "
             "[0]\n"),
     AT(3) "'0' stands where '(' must follow a point"},
    {MESH_OF("point3f[] points = 3\nint[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0]\n"),
     AT(3) "'3' stands where '[' must follow points"},
    {MESH_OF("point3f[] points = [(0,0,0)\n(1,0,0)]\nint[] faceVertexCounts = [3]\nint[] "
             "faceVertexIndices = [0]\n"),
     AT(4) "'(' stands where ']' must follow points"},
    {MESH_OF("point3f[] points = [(0,\n0x1,0)]\nint[] faceVertexCounts = [3]\nint[] "
             "faceVertexIndices = [0]\n"),
     AT(4) "a point: not a number: '0x1'"},
    {MESH_OF("point3f[] points = [(0,\nnan,0)]\nint[] faceVertexCounts = [3]\nint[] "
             "faceVertexIndices = [0]\n"),
     AT(4) "a point: not a finite number: 'nan'"},
    {MESH_OF("point3f[] points = [(0,-inf,0)]\nint[] faceVertexCounts = [3]\nint[] "
             "faceVertexIndices = [0]\n"),
     AT(3) "a point: not a finite number: '-inf'"},
    {MESH_OF("point3f[] points = [(0,2e30,0)]\nint[] faceVertexCounts = [3]\nint[] "
             "faceVertexIndices = [0]\n"),
     AT(3) "coordinate y of a point is 2e+30, beyond the largest that is read, 1e+30"},
    {MESH_OF("point3f[] points = [(0,None,0)]\nint[] faceVertexCounts = [3]\nint[] "
             "faceVertexIndices = [0]\n"),
     AT(3) "a point needs a number, not 'None'"},
    {MESH_OF("int[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0]\n"),
     AT(2) "no mesh has points and faces; the first without is 'm'"},
    /* Faces */
    {MESH_OF(Q3 "int[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0,1,\n3]\n"),
     AT(6) "faceVertexIndices has 3, but the mesh has 3 points"},
    {MESH_OF(Q3 "int[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0,1,-1]\n"),
     AT(5) "faceVertexIndices has -1, but the mesh has 3 points"},
    {MESH_OF(
         Q3 "int[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0,1,99999999999999999999]\n"),
     AT(5) "faceVertexIndices has 9999999999999, but the mesh has 3 points"},
    {MESH_OF(Q3 "int[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0,1,1.5]\n"),
     AT(5) "faceVertexIndices needs a whole number, not '1.5'"},
    {MESH_OF(Q3 "int[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0,1,-]\n"),
     AT(5) "faceVertexIndices needs a whole number, not '-'"},
    {MESH_OF(Q3 "int[] faceVertexCounts = [4]\nint[] faceVertexIndices = [0,1,2]\n"),
     AT(5) "faceVertexIndices ends before the last corner that faceVertexCounts has"},
    {MESH_OF(Q3 "int[] faceVertexCounts = [2000000000]\nint[] faceVertexIndices = [0,1,2]\n"),
     AT(5) "faceVertexIndices ends before the last corner that faceVertexCounts has"},
    {MESH_OF(Q3 "int[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0,1,2,0]\n"),
     AT(5) "faceVertexIndices has more corners than faceVertexCounts"},
    {MESH_OF(Q3 "int[] faceVertexCounts = [-3]\nint[] faceVertexIndices = [0,1,2]\n"),
     AT(4) "faceVertexCounts has -3, below 0"},
    {MESH_OF(Q3 "int[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0,\n1,1]\n"),
     AT(5) "no face of 1 can be drawn; this is a face with fewer than 3 different corners"},
    /* Tags */
    {PAIR_AND("int[] creaseIndices = [0,1,4]\nint[] creaseLengths = [2]\nfloat[] creaseSharpnesses "
              "= [1]\n"),
     AT(7) "creaseLengths add up to 2, but creaseIndices has 3"},
    {PAIR_AND("int[] creaseIndices = [0,1]\nfloat[] creaseSharpnesses = [1]\n"),
     AT(2) "creaseLengths add up to 0, but creaseIndices has 2"},
    {PAIR_AND("int[] creaseIndices = [0,1]\nint[] creaseLengths = [1,1]\nfloat[] creaseSharpnesses "
              "= [1]\n"),
     AT(7) "creaseLengths has 1, needs at least 2"},
    {PAIR_AND("int[] creaseIndices = [0,1,4]\nint[] creaseLengths = [3]\nfloat[] creaseSharpnesses "
              "= [1,2,3]\n"),
     AT(8) "3 creaseSharpnesses for 1 creases of 2 edges: give one for each crease, or one for "
           "each edge"},
    {PAIR_AND("int[] creaseIndices = [0,1]\nint[] creaseLengths = [2]\nfloat[] creaseSharpnesses = "
              "[nan]\n"),
     AT(8) "creaseSharpnesses: not a finite number: 'nan'"},
    {PAIR_AND("int[] creaseIndices = [0,1]\nint[] creaseLengths = [2]\nfloat[] creaseSharpnesses = "
              "[1e99]\n"),
     AT(8) "creaseSharpnesses: too large a number: '1e99'"},
    {PAIR_AND("int[] cornerIndices = [0,1]\nfloat[] cornerSharpnesses = [1]\n"),
     AT(7) "1 cornerSharpnesses for 2 cornerIndices"},
    {PAIR_AND("int[] holeIndices = [(1)]\n"), AT(6) "holeIndices needs a number, not '('"},
    {PAIR_AND("uniform token interpolateBoundary = \"edges\"\n"),
     AT(6) "interpolateBoundary is 'edges', needs one of none, edgeOnly, edgeAndCorner"},
    {PAIR_AND("uniform token triangleSubdivisionRule = 3\n"),
     AT(6) "triangleSubdivisionRule needs a word in quotes, not '3'"},
    {PAIR_AND("uniform token orientation = \"\"\n"),
     AT(6) "orientation is '', needs one of rightHanded, leftHanded"},
    {PAIR_AND("uniform token subdivisionScheme = \"none\"\n"),
     AT(6) "Mesh 'm' has subdivisionScheme none: it is a polygon mesh and no cage; export it with "
           "its subdivision scheme, or hide it"},
    /* Settings that a cage has once */
    {MESH_OF(USD_PAIR) USD_MESH(USD_PAIR "uniform token subdivisionScheme = \"loop\"\n"),
     AT(7) "subdivisionScheme of Mesh 'm' differs from that of the mesh in line 2, and a model has "
           "one: write a file for each"},
    {MESH_OF(USD_PAIR) USD_MESH(USD_PAIR "uniform token interpolateBoundary = \"none\"\n"),
     AT(7) "interpolateBoundary of Mesh 'm' differs from that of the mesh in line 2, and a model "
           "has one: write a file for each"},
    {MESH_OF(Q3 "int[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0,1,2]\n")
         USD_MESH(Q3 "int[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0,1,2]\n"
                     "uniform token triangleSubdivisionRule = \"smooth\"\n"),
     AT(7) "triangleSubdivisionRule of Mesh 'm' differs from that of the mesh in line 2, and a "
           "model has one: write a file for each"},
    {USD "( upAxis = \"X\" )\n", AT(2) "upAxis is 'X', needs Y or Z"},
    {USD "( metersPerUnit = 0 )\n", AT(2) "metersPerUnit is 0, needs more than 0"},
    /* Transforms */
    {PAIR_AND(
         "uniform token[] xformOpOrder = [\"xformOp:shear\"]\nfloat3 xformOp:shear = (1,2,3)\n"),
     AT(6) "'xformOp:shear' is no xformOp that is known"},
    {PAIR_AND("uniform token[] xformOpOrder = [\"xformOp:scale\"]\nfloat3 xformOp:scale = (1,2)\n"),
     AT(7) "scale has 2 numbers, needs 3"},
    {PAIR_AND("uniform token[] xformOpOrder = [3]\n"),
     AT(6) "xformOpOrder needs a word in quotes, not '3'"},
    {PAIR_AND("uniform token[] xformOpOrder = [\"!invert!xformOp:scale\"]\nfloat3 xformOp:scale = "
              "(1,0,2)\n"),
     AT(7) "'xformOp:scale' has no inverse"},
    {PAIR_AND("matrix4d xformOp:transform = ((1,0,0,1),(0,1,0,0),(0,0,1,0),(0,0,0,1))\n"
              "uniform token[] xformOpOrder = [\"xformOp:transform\"]\n"),
     AT(6) "the last column of transform must be 0 0 0 1"},
    {PAIR_AND("float xformOp:rotateX.spline = { 1: 2 }\nuniform token[] xformOpOrder = "
              "[\"xformOp:rotateX\"]\n"),
     AT(6) "xformOp:rotateX is given by a spline, which is not read: give it a value"},
    {PAIR_AND("float3 xformOp:scale = (1e300,1,1)\nfloat3 xformOp:scale:b = (1e300,1,1)\n"
              "uniform token[] xformOpOrder = [\"xformOp:scale\", \"xformOp:scale:b\"]\n"),
     AT(3) "a point is not finite where its prims put it"},
    /* What takes content from elsewhere */
    {USD "(\nsubLayers = [@a.usda@]\n)\n",
     AT(3) "the file takes content from other files by subLayers, and no other file is read: make "
           "one file of them by usdcat --flatten"},
    {USD "def \"a\" (\nprepend references = @a.usd@</b> (offset = 1)\n) {}\n",
     AT(3) "'a' takes content from elsewhere by references" FLATTEN},
    {USD "def \"a\" ( instanceable = true\nreferences = </b> ) {}\n",
     AT(3) "'a' takes content from elsewhere by references" FLATTEN
           ", after instanceable = true was removed"},
    {USD "def \"a\" ( payload = @a.usd@ ) {}\n",
     AT(2) "'a' takes content from elsewhere by a payload" FLATTEN},
    {USD "def \"a\" ( inherits = </c> ) {}\n",
     AT(2) "'a' takes content from elsewhere by inherits" FLATTEN},
    {USD "def \"a\" ( specializes = </c> ) {}\n",
     AT(2) "'a' takes content from elsewhere by specializes" FLATTEN},
    {USD "def \"a\" ( variants = { string b = \"c\" } ) {}\n",
     AT(2) "'a' takes content from elsewhere by variants" FLATTEN},
    {USD "def \"a\" {\nvariantSet \"b\" = { \"c\" {} }\n}\n",
     AT(3) "'a' takes content from elsewhere by variants" FLATTEN},
    {USD "def \"a\" ( clips = { dictionary d = {} } ) {}\n",
     AT(2) "'a' takes content from elsewhere by value clips" FLATTEN},
    {USD "def PointInstancer \"a\" {}\n",
     AT(2) "PointInstancer 'a' is not read: export its instances as meshes of their own"},
    /* Nothing is left */
    {USD "def Cube \"a\" {}\n", AT(2) "no geometry is a Mesh; the first that is not is 'a'"},
    {USD "def Mesh \"a\" { token visibility = \"invisible\" }\n",
     AT(2) "all meshes are invisible; the first is 'a'"},
    {USD "def Mesh \"a\" { uniform token purpose = \"guide\" }\n",
     AT(2) "all meshes are of purpose guide or proxy; the first is 'a'"},
    {USD "def Mesh \"a\" { uniform token purpose = \"hidden\" }\n",
     AT(2) "purpose is 'hidden', needs one of default, render, proxy, guide"},
    {USD "over \"a\" {\n" USD_MESH(USD_PAIR) "}\n",
     "part.usda: all meshes are in prims that are inactive, over or class"},
};

static void test_messages(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof BAD / sizeof *BAD; i++)
        expect_bad_usd(BAD[i].text, strlen(BAD[i].text), BAD[i].message);
}

/* A file that ends at any byte is read or refused, and never read beyond its end. Only the last bracket can be
 * cut off without a message: it is not. */
static void test_cut_off(void **state)
{
    (void)state;
    static const char text[] =
        USD "(\n upAxis = \"Z\"\n)\ndef Xform \"a\" ( kind = \"x\" )\n{\ndouble3 xformOp:translate "
            "= (1,2,3)\n"
            "uniform token[] xformOpOrder = [\"xformOp:translate\"]\n" USD_MESH(
                USD_PAIR "int[] creaseIndices = [0,1]\nint[] creaseLengths = [2]\nfloat[] "
                         "creaseSharpnesses = [1]\n") "}";
    for (size_t size = 0; size <= sizeof text - 1; size++) {
        struct cage cage;
        struct error error = {0};
        char *bytes = malloc(size ? size : 1);
        assert_non_null(bytes);
        memcpy(bytes, text, size);
        bool ok = cage_read(&cage, bytes, size, "part.usda", &error);
        free(bytes);
        assert_true(ok == (size == sizeof text - 1));
        if (ok)
            cage_finish(&cage);
        else
            assert_true(error.kind == ERROR_MODEL && !strchr(error.text, '\n'));
    }
}

/* Nesting is bounded, by brackets and by prims. */
static void test_depth(void **state)
{
    (void)state;
    enum { DEEP = 200 };
    char text[40 * DEEP] = USD;
    for (int i = 0; i < DEEP; i++)
        strcat(text, "def \"a\" {\n");
    expect_bad_usd(text, strlen(text), AT(130) "prims are nested deeper than 128");
    strcpy(text, USD "def \"a\" {\nint b =\n");
    for (int i = 0; i < DEEP; i++)
        strcat(text, "[\n");
    expect_bad_usd(text, strlen(text), AT(132) "values are nested deeper than 128");
}

/* The number of ops of a prim is bounded, so that looking for their names is not slow. */
static void test_many_ops(void **state)
{
    (void)state;
    enum { MANY = 200 };
    char text[60 * MANY] = USD "def Xform \"a\" {\n";
    for (int i = 0; i < MANY; i++)
        sprintf(text + strlen(text), "float xformOp:rotateX:a%d = 1\n", i);
    strcat(text, "}\n");
    expect_bad_usd(text, strlen(text), AT(131) "more than 128 xformOps of a prim are not read");
    strcpy(text, USD "def Xform \"a\" {\nuniform token[] xformOpOrder = [");
    for (int i = 0; i < MANY; i++)
        strcat(text, "\"xformOp:rotateX\",");
    strcat(text, "]\n}\n");
    expect_bad_usd(text, strlen(text), AT(3) "more than 128 entries of xformOpOrder are not read");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_messages),
        cmocka_unit_test(test_cut_off),
        cmocka_unit_test(test_depth),
        cmocka_unit_test(test_many_ops),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
