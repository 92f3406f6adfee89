/* Malformed and malicious glTF files: each is refused with its message. */
#include "server/cage/read/read.h"
#include "tests/unit/gltf_sample.h"

#include <math.h>

static void test_node_errors(void **state)
{
    (void)state;
    static const struct {
        const char *nodes, *message;
    } bad[] = {
        {"{\"mesh\":1}", "part.glb: a node refers to mesh 1, but there are 1"},
        {"{\"mesh\":-2}", "part.glb: a node refers to mesh -2, but there are 1"},
        {"{\"children\":[0]}", "part.glb: node 0 is reached twice: a cycle, or two parents"},
        {"{\"children\":[1]},{\"children\":[2]},{\"children\":[1]}",
         "part.glb: node 1 is reached twice: a cycle, or two parents"},
        {"{\"children\":[1,2]},{\"children\":[2]},{\"mesh\":0}",
         "part.glb: node 2 is reached twice: a cycle, or two parents"},
        {"{\"children\":[5]}", "part.glb: the scene refers to node 5, but there are 1"},
        {"{\"children\":[-1]}", "part.glb: the scene refers to node -1, but there are 1"},
        {"", "part.glb: the scene refers to node 0, but there are 0"},
        {"{\"mesh\":0,\"matrix\":[1,2,3]}", "part.glb: node 0: matrix needs 16 finite numbers"},
        {"{\"mesh\":0,\"matrix\":[1,0,0,1,0,1,0,0,0,0,1,0,0,0,0,1]}",
         "part.glb: node 0: the last row of matrix must be 0 0 0 1"},
        {"{\"mesh\":0,\"scale\":[1,1]}", "part.glb: node 0: scale needs 3 finite numbers"},
        {"{\"mesh\":0,\"rotation\":[1,1,0]}", "part.glb: node 0: rotation needs 4 finite numbers"},
        {"{\"mesh\":0,\"scale\":[1,1e31,1]}",
         "part.glb: vertex 3 (counting from 0) has coordinate y = 1e+31, beyond the largest"},
        {"{\"mesh\":0,\"translation\":[0,1e999,0]}", "part.glb: not a glTF file that can be read"},
        {"{}", "part.glb: no face at all (0 vertices)"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        expect_bad(&(struct sample){.nodes = bad[i].nodes}, bad[i].message);
    expect_bad(&(struct sample){.scene = "\"scene\":3,\"scenes\":[{\"nodes\":[0]}]"},
               "part.glb: the default scene is 3, but there are 1");
    expect_bad(&(struct sample){.scene = "\"scene\":0"},
               "part.glb: the default scene is 0, but there are 0");
}

/* A chain of 200000 nodes: a reader that recursed would overflow its stack. */
static void test_deep_nodes(void **state)
{
    (void)state;
    enum { N = 200000 };
    char *json = malloc(N * 30 + 1000), *at = json;
    assert_non_null(json);
    at += sprintf(at, "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}],\"nodes\":[");
    for (int i = 0; i < N; i++)
        at += sprintf(at, "{\"children\":[%d]},", i + 1);
    sprintf(at, "{}]}");
    expect_text_bad(json, "part.glb: no face at all (0 vertices): a cage needs at least one face");
    free(json);
}

/* Malformed primitives and accessors */

static void test_primitive_errors(void **state)
{
    (void)state;
    static const struct {
        const char *primitive, *message;
    } bad[] = {
        {"\"mode\":0", "part.glb: it holds points and lines alone: no triangle makes a surface"},
        {"\"mode\":3", "part.glb: it holds points and lines alone: no triangle makes a surface"},
        {"\"mode\":7", "part.glb: mesh 0 primitive 0 has mode 7, but glTF has 0 to 6"},
        {"\"mode\":-1", "part.glb: mesh 0 primitive 0 has mode -1, but glTF has 0 to 6"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        expect_bad(&(struct sample){.primitive = bad[i].primitive}, bad[i].message);
    expect_bad(&(struct sample){.meshes = "{\"primitives\":[{\"attributes\":{\"NORMAL\":0}}]}"},
               "part.glb: none of its triangles has a POSITION");
    expect_bad(&(struct sample){.meshes = "{\"primitives\":[{\"attributes\":{\"POSITION\":9}}]}"},
               "part.glb: mesh 0 primitive 0: POSITION refers to accessor 9, but there are 2");
    expect_bad(&(struct sample){.meshes = "{\"primitives\":[{\"attributes\":{\"POSITION\":-1}}]}"},
               "part.glb: mesh 0 primitive 0: POSITION refers to accessor -1, but there are 2");
    expect_bad(&(struct sample){.meshes = "{\"primitives\":[{\"attributes\":{\"POSITION\":0},"
                                          "\"indices\":-7}]}"},
               "part.glb: mesh 0 primitive 0: indices refers to accessor -7, but there are 2");
    expect_bad(&(struct sample){.meshes = "{\"primitives\":[{\"attributes\":{\"POSITION\":0},"
                                          "\"indices\":2}]}"},
               "part.glb: not a glTF file that can be read: primitive indices accessor out of");
    /* tinygltf would drop this primitive without an error and read the rest. */
    expect_bad(&(struct sample){.meshes = "{\"primitives\":[{\"attributes\":{\"POSITION\":0}},"
                                          "{\"indices\":1}]}"},
               "part.glb: not a glTF file that can be read: 'attributes' property is missing");
}

#define POSITIONS "{\"bufferView\":0,\"componentType\":5126,\"type\":\"VEC3\",\"count\":6}"
#define INDICES "{\"bufferView\":1,\"componentType\":5123,\"type\":\"SCALAR\",\"count\":12}"

static void test_accessor_errors(void **state)
{
    (void)state;
    static const struct {
        const char *accessors, *message;
    } bad[] = {
        {"{\"bufferView\":0,\"componentType\":5126,\"type\":\"VEC3\",\"count\":7}," INDICES,
         "POSITION has 7 elements, more than its buffer view of 72 bytes holds"},
        {"{\"bufferView\":0,\"componentType\":5126,\"type\":\"VEC3\","
         "\"count\":18446744073709551615}," INDICES,
         "POSITION has 18446744073709551615 elements, more than its buffer view of 72 bytes"},
        {"{\"bufferView\":0,\"componentType\":5126,\"type\":\"VEC3\",\"count\":"
         "1537228672809129302}," INDICES, /* this count times 12 bytes overflows to 8 */
         "POSITION has 1537228672809129302 elements, more than its buffer view of 72 bytes"},
        {"{\"bufferView\":0,\"byteOffset\":4,\"componentType\":5126,\"type\":\"VEC3\","
         "\"count\":6}," INDICES,
         "POSITION has 6 elements, more than its buffer view of 72 bytes holds"},
        {"{\"bufferView\":0,\"byteOffset\":18446744073709551608,\"componentType\":5126,"
         "\"type\":\"VEC3\",\"count\":6}," INDICES,
         "POSITION has 6 elements, more than its buffer view of 72 bytes holds"},
        {"{\"bufferView\":0,\"componentType\":5126,\"type\":\"VEC3\",\"count\":0}," INDICES,
         "POSITION has no element"},
        {"{\"bufferView\":0,\"componentType\":5125,\"type\":\"VEC3\",\"count\":6}," INDICES,
         "POSITION must be VEC3 of floats (5126), or of integers of 8 or 16 bits"},
        {"{\"bufferView\":0,\"componentType\":5126,\"type\":\"VEC4\",\"count\":4}," INDICES,
         "POSITION must be VEC3 of floats (5126), or of integers of 8 or 16 bits"},
        {"{\"bufferView\":0,\"componentType\":5130,\"type\":\"VEC3\",\"count\":2}," INDICES,
         "POSITION must be VEC3 of floats (5126), or of integers of 8 or 16 bits"},
        {"{\"bufferView\":4,\"componentType\":5126,\"type\":\"VEC3\",\"count\":6}," INDICES,
         "POSITION has buffer view 4, but there are 2"},
        {"{\"componentType\":5126,\"type\":\"VEC3\",\"count\":6}," INDICES,
         "POSITION has no buffer view, so it holds no data"},
        {"{\"bufferView\":0,\"componentType\":5126,\"type\":\"VEC3\",\"count\":5}," INDICES,
         "index 8 is vertex 5, but POSITION has 5"},
        {POSITIONS ",{\"bufferView\":1,\"componentType\":5123,\"type\":\"SCALAR\",\"count\":13}",
         "indices has 13 elements, more than its buffer view of 24 bytes holds"},
        {POSITIONS ",{\"bufferView\":1,\"componentType\":5123,\"type\":\"SCALAR\",\"count\":11}",
         "11 indices do not make whole triangles"},
        {POSITIONS ",{\"bufferView\":1,\"componentType\":5122,\"type\":\"SCALAR\",\"count\":12}",
         "indices must be unsigned scalars"},
        {POSITIONS ",{\"bufferView\":1,\"componentType\":5126,\"type\":\"SCALAR\",\"count\":6}",
         "indices must be unsigned scalars"},
        {POSITIONS ",{\"bufferView\":1,\"componentType\":5123,\"type\":\"VEC2\",\"count\":6}",
         "indices must be unsigned scalars"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char message[200];
        snprintf(message, sizeof message, "part.glb: mesh 0 primitive 0: %s", bad[i].message);
        expect_bad(&(struct sample){.accessors = bad[i].accessors}, message);
    }
}

static void test_view_errors(void **state)
{
    (void)state;
    static const struct {
        const char *views, *message;
    } bad[] = {
        {"{\"buffer\":0,\"byteLength\":97},{\"buffer\":0,\"byteLength\":24}",
         "the buffer view of POSITION ends beyond its buffer of 96 bytes"},
        {"{\"buffer\":0,\"byteOffset\":97,\"byteLength\":1},{\"buffer\":0,\"byteLength\":24}",
         "the buffer view of POSITION ends beyond its buffer of 96 bytes"},
        {"{\"buffer\":0,\"byteOffset\":18446744073709551615,\"byteLength\":73},"
         "{\"buffer\":0,\"byteLength\":24}",
         "the buffer view of POSITION ends beyond its buffer of 96 bytes"},
        {"{\"buffer\":1,\"byteLength\":72},{\"buffer\":0,\"byteLength\":24}",
         "POSITION has buffer 1, but there are 1"},
        {"{\"buffer\":-1,\"byteLength\":72},{\"buffer\":0,\"byteLength\":24}",
         "POSITION has buffer -1, but there are 1"},
        {"{\"buffer\":0,\"byteLength\":72,\"byteStride\":8},{\"buffer\":0,\"byteLength\":24}",
         "the stride of POSITION is 8 bytes, an element has 12"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char message[200];
        snprintf(message, sizeof message, "part.glb: mesh 0 primitive 0: %s", bad[i].message);
        expect_bad(&(struct sample){.views = bad[i].views}, message);
    }
}

/* tinygltf would read each of these values as 0. */
static void test_offsets_and_strides(void **state)
{
    (void)state;
    static const char *const values[] = {
        "-4",   "-0",    "1.5", "0.0",  "1e1", "18446744073709551616", "99999999999999999999999",
        "null", "\"4\"", "[0]", "true", "{}",
    };
    static const char *const shown[] = {
        "-4",   "-0",    "1.5", "0.0",  "1e1", "18446744073709551616", "99999999999999999999999",
        "null", "\"4\"", "[0",  "true", "{",
    };
    static const char *const keys[] = {"byteOffset", "byteStride"};
    char text[300], message[200];
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        snprintf(text, sizeof text,
                 POSITIONS ",{\"bufferView\":1,\"byteOffset\" :\n %s,\"componentType\":5123,"
                           "\"type\":\"SCALAR\",\"count\":12}",
                 values[i]);
        snprintf(message, sizeof message,
                 "part.glb: accessor 1: byteOffset is %s; it must be a whole number from 0 up",
                 shown[i]);
        expect_bad(&(struct sample){.accessors = text}, message);
        for (int k = 0; k < 2; k++) {
            snprintf(text, sizeof text,
                     "{\"buffer\":0,\"byteLength\":72,\"%s\":%s},"
                     "{\"buffer\":0,\"byteOffset\":72,\"byteLength\":24}",
                     keys[k], values[i]);
            snprintf(message, sizeof message,
                     "part.glb: buffer view 0: %s is %s; it must be a whole number from 0 up",
                     keys[k], shown[i]);
            expect_bad(&(struct sample){.views = text}, message);
        }
    }
    expect_bad(&(struct sample){.views = "{\"buffer\":0,\"byteLength\":72,\"byte\\u004fffset\":-4},"
                                         "{\"buffer\":0,\"byteOffset\":72,\"byteLength\":24}"},
               "part.glb: a key of buffer view 0 is spelt with escapes");
    /* The same words are allowed where they are no keys of a buffer view. */
    struct sample good = {.views =
                              "{\"name\":\"byteOffset\",\"buffer\":0,\"byteLength\":72,"
                              "\"extras\":{\"byteOffset\":-4}},{\"name\":\"\\\"x\",\"buffer\":0,"
                              "\"byteOffset\" : 72 ,\"byteLength\":24}"};
    struct cage cage;
    read_good(&cage, &good);
    assert_int_equal(cage.n_faces, 2);
    cage_finish(&cage);
}

static void test_coordinates(void **state)
{
    (void)state;
    float positions[18];
    memcpy(positions, GRID, sizeof positions);
    positions[13] = NAN;
    struct sample sample = {.positions = positions, .n_positions = 6};
    expect_bad(&sample, "part.glb: mesh 0 primitive 0: POSITION 4 is not finite");
    positions[13] = -INFINITY;
    expect_bad(&sample, "part.glb: mesh 0 primitive 0: POSITION 4 is not finite");
    positions[13] = 3e38f;
    expect_bad(&sample, "part.glb: vertex 4 (counting from 0) has coordinate y = 3e+38, beyond");
}

/* Files */

static void test_other_files(void **state)
{
    (void)state;
    expect_bad(&(struct sample){.buffers = "{\"byteLength\":96,\"uri\":\"parts%2F../x.bin\"}"},
               "part.glb: it refers to the file 'parts/../x.bin', but nothing outside the given "
               "file is read: export as GLB or with embedded buffers");
    expect_bad(&(struct sample){.buffers = "{\"byteLength\":96,\"uri\":\"/etc/passwd\"}"},
               "part.glb: it refers to the file '/etc/passwd', but nothing outside");
    expect_bad(&(struct sample){.buffers = "{\"byteLength\":96,\"uri\":\"Makefile\"}"},
               "part.glb: it refers to the file 'Makefile', but nothing outside");
    expect_bad(&(struct sample){.buffers = "{\"byteLength\":96,\"uri\":\"data:a/b,xyz\"}"},
               "part.glb: its 'data:a/b,xyz...' is no data: URI that is read: "
               "application/octet-stream in base64 is");
    expect_bad(&(struct sample){.buffers = "{\"byteLength\":97}"},
               "part.glb: not a glTF file that can be read: Invalid `byteLength'");
    expect_bad(&(struct sample){.buffers = "{\"byteLength\":0}"},
               "part.glb: not a glTF file that can be read");
    expect_text_bad("glTF", "part.glb: truncated: a GLB has at least 20 bytes, the file has 4");
    /* Images are not read, so a missing, broken or external one is no error. */
    struct cage cage;
    read_good(&cage, &(struct sample){
                         .top = "\"images\":[{\"uri\":\"/etc/passwd\"},{\"uri\":\"data:image/png;"
                                "base64,AAAA\"},{\"bufferView\":0,\"mimeType\":\"image/png\"}],"});
    assert_int_equal(cage.n_faces, 2);
    cage_finish(&cage);
}

static void test_data_uri(void **state)
{
    (void)state;
    static const char json[] =
        "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{"
        "\"attributes\":{\"POSITION\":0}}]}],\"accessors\":[{\"bufferView\":0,\"componentType\":"
        "5126,\"type\":\"VEC3\",\"count\":3}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],"
        "\"buffers\":[{\"byteLength\":36,\"uri\":\"data:application/octet-stream;base64,"
        "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAACAPwAAgD8AAAAA\"}]}";
    struct cage cage;
    struct error error = {0};
    if (!cage_read(&cage, json, strlen(json), "part.gltf", &error))
        fail_msg("%s", error.text);
    expect_position(&cage, 2, 1, 1, 0);
    cage_finish(&cage);
    char *longer = strdup(json), *at = strstr(longer, "\"byteLength\":36,\"uri\"");
    at[14] = '9';
    assert_false(cage_read(&cage, longer, strlen(longer), "part.gltf", &error));
    assert_non_null(strstr(error.text, "part.gltf: not a glTF file that can be read: Failed to"));
    free(longer);
}

static void test_glb_header(void **state)
{
    (void)state;
    struct bytes file = make_file(&(struct sample){0});
    static const struct {
        size_t at;
        uint32_t value;
        const char *message;
    } bad[] = {
        {4, 1, "part.glb: glTF 1.0 (GLB version 1); only 2.0 is read: export it as 2.0"},
        {4, 3, "part.glb: GLB version 3, only version 2 is read"},
        {8, 0x80000000u, "part.glb: truncated: its header says 2147483648 bytes, the file has"},
        {8, 0xffffffffu, "part.glb: truncated: its header says 4294967295 bytes, the file has"},
        {8, 19, "part.glb: the JSON chunk says"},
        {8, 0, "part.glb: the JSON chunk says"},
        {12, 0xfffffffcu, "part.glb: the JSON chunk says 4294967292 bytes, but the GLB ends"},
        {12, 0x80000000u, "part.glb: the JSON chunk says 2147483648 bytes, but the GLB ends"},
        {16, 0x004e4942u, "part.glb: the first chunk of the GLB is not JSON"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        unsigned char kept[4];
        memcpy(kept, file.data + bad[i].at, 4);
        put_u32(file.data + bad[i].at, bad[i].value);
        expect_bytes_bad(file.data, file.size, bad[i].message);
        memcpy(file.data + bad[i].at, kept, 4);
    }
    size_t chunk = file.size - 96 - 8;
    put_u32(file.data + chunk, 0x80000000u);
    expect_bytes_bad(file.data, file.size,
                     "part.glb: the BIN chunk says 2147483648 bytes, but only 96 are left");
    put_u32(file.data + chunk, 100);
    expect_bytes_bad(file.data, file.size,
                     "part.glb: the BIN chunk says 100 bytes, but only 96 are left");
    put_u32(file.data + chunk, 92);
    expect_bytes_bad(file.data, file.size, "part.glb: not a glTF file that can be read");
    put_u32(file.data + chunk + 4, 0x12345678);
    expect_bytes_bad(file.data, file.size, "part.glb: the second chunk of the GLB is not BIN");
    free(file.data);
}

/* A file cut off at any byte is refused, also if the header gives the shorter length. */
static void test_truncated(void **state)
{
    (void)state;
    struct bytes file = make_file(&(struct sample){0});
    for (size_t size = 1; size < file.size; size++) {
        /* a block of exactly this size, so that a sanitizer finds every read beyond it */
        unsigned char *cut = malloc(size);
        assert_non_null(cut);
        memcpy(cut, file.data, size);
        if (size >= 4)
            expect_bytes_bad(cut, size, "part.glb: truncated: ");
        if (size >= 20) {
            put_u32(cut + 8, (uint32_t)size);
            expect_bytes_bad(cut, size, "part.glb: ");
        }
        free(cut);
    }
    free(file.data);
}

static void test_bad_json(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "{",
        "{}",
        "[]",
        "null",
        "{\"asset\":1}",
        "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[1]}",
        "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[[]]}",
        "{\"a\":\"\\ud800\"}",
        "{\"a\":1e999}",
        "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":5,\"uri\":\"data:;base64,\"}"
        "]}",
        "{\"x",
        "{\"\\",
        "\xff\xfe{}",
    };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        expect_text_bad(texts[i], "part.glb: ");
    expect_text_bad("{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{}]}",
                    "part.glb: no face at all");
}

static char *repeat(const char *head, const char *part, size_t n, const char *tail)
{
    size_t length = strlen(part);
    char *text = malloc(strlen(head) + n * length + strlen(tail) + 1);
    assert_non_null(text);
    char *at = stpcpy(text, head);
    for (size_t i = 0; i < n; i++, at += length)
        memcpy(at, part, length);
    strcpy(at, tail);
    return text;
}

/* Small files that would exhaust the stack or the memory of a careless reader. */
static void test_bombs(void **state)
{
    (void)state;
    char *text = repeat("{\"extras\":", "[", 1000000, "");
    expect_text_bad(text, "part.glb: JSON nested deeper than 64 levels");
    free(text);
    text = repeat("{\"extras\":", "{\"a\":", 100, "1");
    expect_text_bad(text, "part.glb: JSON nested deeper than 64 levels");
    free(text);
    text = repeat("{\"asset\":{\"version\":\"2.0\"},\"extras\":\"", "[{", 100, "\"}");
    /* brackets within a string are not nesting */
    expect_text_bad(text, "part.glb: no face at all");
    free(text);
    text = repeat("{\"extras\":[", "1,", 4000001, "1]}");
    expect_text_bad(text, "part.glb: more than 4000000 values in the JSON");
    free(text);

    static const char chunk[64];
    text = repeat("{\"asset\":{\"version\":\"2.0\"},\"buffers\":[", "{\"byteLength\":64},", 4,
                  "{\"byteLength\":64}]}");
    struct bytes file = make_glb(text, chunk, sizeof chunk);
    expect_bytes_bad(file.data, file.size, "part.glb: 5 buffers in a GLB, at most 4 are read");
    free(file.data);
    free(text);
    expect_text_bad("{\"b\\u0075ffers\":[]}",
                    "part.glb: a top-level key of the JSON is spelt with escapes");
}

/* What does not begin like JSON is not searched for the faults of JSON. */
static void test_not_json(void **state)
{
    (void)state;
    static const char *const texts[] = {"hello { \"C:\\models\" }", "[{\"b\\u0075ffers\":[]}]",
                                        "\xef\xbb\xbf \n", " "};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        expect_bytes_bad(texts[i], strlen(texts[i]),
                         "part.glb: not a glTF file: it begins neither with '{' (JSON) nor with "
                         "'glTF' (GLB)");
        struct bytes file = make_glb(texts[i], NULL, 0);
        expect_bytes_bad(file.data, file.size,
                         "part.glb: the JSON of the GLB does not begin with '{'");
        free(file.data);
    }
    expect_text_bad("\xef\xbb\xbf {\"b\\u0075ffers\":[]}",
                    "part.glb: a top-level key of the JSON is spelt with escapes");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_node_errors),
        cmocka_unit_test(test_deep_nodes),
        cmocka_unit_test(test_primitive_errors),
        cmocka_unit_test(test_accessor_errors),
        cmocka_unit_test(test_view_errors),
        cmocka_unit_test(test_offsets_and_strides),
        cmocka_unit_test(test_coordinates),
        cmocka_unit_test(test_other_files),
        cmocka_unit_test(test_data_uri),
        cmocka_unit_test(test_glb_header),
        cmocka_unit_test(test_truncated),
        cmocka_unit_test(test_bad_json),
        cmocka_unit_test(test_bombs),
        cmocka_unit_test(test_not_json),
    };
    return cmocka_run_group_tests_name("cage/gltf_bad", tests, NULL, NULL);
}
