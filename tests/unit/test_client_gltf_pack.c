/* A .gltf file and the files beside it become one GLB; no file outside its folder is read. */
#include "client/lib/files/gltf_pack.h"
#include "protocol/limits.h"
#include "tests/unit/gltf_sample.h"

#include <sys/stat.h>
#include <unistd.h>

/* The tests run in the folder model/, so that there are files outside of it. */
static char folder[64];

static void put_file(const char *path, const void *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

static int setup(void **state)
{
    (void)state;
    strcpy(folder, "/tmp/sheen-test-XXXXXX");
    if (!mkdtemp(folder) || chdir(folder) != 0 || mkdir("model", 0700) != 0)
        return -1;
    put_file("secret.bin", "secrets!", 8);
    if (chdir("model") != 0 || mkdir("sub", 0700) != 0 || mkdir("sub/deep", 0700) != 0)
        return -1;
    put_file("a.bin", "abcdefgh", 8);
    put_file("sub/b c.bin", "ijklm", 5);
    put_file("100%.bin", "percent!", 8);
    put_file("sub/deep/\xc3\xa4.bin", "umlaut!!", 8);
    put_file("none.bin", "", 0);
    if (symlink("../secret.bin", "out.bin") != 0 || symlink("..", "up") != 0 ||
        symlink("sub/b c.bin", "in.bin") != 0 || symlink("loop.bin", "loop.bin") != 0 ||
        mkfifo("pipe.bin", 0600) != 0)
        return -1;
    return 0;
}

static int teardown(void **state)
{
    (void)state;
    static const char *const files[] = {
        "a.bin",    "sub/b c.bin",  "100%.bin", "sub/deep/\xc3\xa4.bin",
        "none.bin", "out.bin",      "up",       "in.bin",
        "loop.bin", "pipe.bin",     "hole.bin", "whole.bin",
        "rest.bin", "../secret.bin"};
    for (size_t i = 0; i < sizeof files / sizeof *files; i++)
        unlink(files[i]);
    rmdir("sub/deep");
    rmdir("sub");
    return chdir("..") == 0 && rmdir("model") == 0 && chdir("/") == 0 ? rmdir(folder) : -1;
}

static enum sheen_status pack(const char *path, const char *json, struct bytes *bytes,
                              struct sheen_error *error)
{
    bytes->data = (unsigned char *)strdup(json);
    assert_non_null(bytes->data);
    bytes->size = strlen(json);
    *error = (struct sheen_error){0};
    return gltf_pack(path, &bytes->data, &bytes->size, error);
}

static void expect_refused(const char *json, enum sheen_status status, const char *text)
{
    struct bytes bytes;
    struct sheen_error error;
    enum sheen_status got = pack("part.gltf", json, &bytes, &error);
    if (got != status || strncmp(error.text, text, strlen(text)) != 0)
        fail_msg("\n%s\nis %d, says: %s\n    should be: %s", json, got, error.text, text);
    assert_int_equal(bytes.size, strlen(json));
    assert_memory_equal(bytes.data, json, bytes.size);
    free(bytes.data);
}

static void expect_unchanged(const char *json)
{
    expect_refused(json, SHEEN_OK, "");
}

/* Compares the whole GLB byte by byte, because its hash is the model's identity. */
static void test_bytes(void **state)
{
    (void)state;
    static const char json[] =
        "\xef\xbb\xbf {\n\"asset\": {\"version\":\"2.0\", \"extras\":0.1},\n \"buffers\":[{\"uri\":"
        "\"a.bin\", \"byteLength\":7},{\"byteLength\":3,\"uri\":\"data:;base64,AAAA\"},\n"
        "{\"uri\":\"sub/b%20c.bin\",\"byteLength\":5},{\"byteLength\":9}],\"bufferViews\":["
        "{\"byteLength\":7,\"buffer\":0},{\"buffer\":2,\"byteOffset\":1,\"byteLength\":4,"
        "\"byteStride\":4},{\"buffer\":1,\"byteOffset\":2,\"byteLength\":1},{\"buffer\":3,"
        "\"byteLength\":9},{\"buffer\":77}],\"images\":[{\"uri\":\"missing.png\"}]}";
    static const char packed[] =
        "{\"asset\":{\"version\":\"2.0\",\"extras\":0.10000000000000001},\"buffers\":[{"
        "\"byteLength\":16},{\"byteLength\":3,\"uri\":\"data:;base64,AAAA\"},{\"byteLength\":9}],"
        "\"bufferViews\":[{\"byteLength\":7,\"buffer\":0,\"byteOffset\":0},{\"buffer\":0,"
        "\"byteOffset\":9,\"byteLength\":4,\"byteStride\":4},{\"buffer\":1,\"byteOffset\":2,"
        "\"byteLength\":1},{\"buffer\":2,\"byteLength\":9},{\"buffer\":77}],\"images\":[{\"uri\":"
        "\"missing.png\"}]}";
    struct bytes expected = make_glb(packed, "abcdefg\0ijklm\0\0\0", 16);
    char absolute[100];
    snprintf(absolute, sizeof absolute, "%s/model/part.gltf", folder);
    const char *const paths[] = {"part.gltf", "./part.gltf", "sub/../part.gltf", absolute};
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        struct bytes bytes;
        struct sheen_error error;
        if (pack(paths[i], json, &bytes, &error) != SHEEN_OK)
            fail_msg("%s", error.text);
        assert_int_equal(bytes.size, expected.size);
        assert_memory_equal(bytes.data, expected.data, bytes.size);
        free(bytes.data);
    }
    free(expected.data);
}

#define NAMES(uri) "{\"buffers\":[{\"byteLength\":5,\"uri\":\"" uri "\"}]}"

static void test_names(void **state)
{
    (void)state;
    static const struct {
        const char *json, *bytes;
    } good[] = {
        {NAMES("a.bin"), "abcde"},
        {NAMES("./a.bin"), "abcde"},
        {NAMES("%61.b%69n"), "abcde"},
        {NAMES("\\u0061.bin"), "abcde"},
        {NAMES("sub/b c.bin"), "ijklm"},
        {NAMES("sub//b%20c.bin"), "ijklm"},
        {NAMES("in.bin"), "ijklm"}, /* a symbolic link within the folder */
        {NAMES("100%.bin"), "perce"},
        {NAMES("100%25.bin"), "perce"},
        {NAMES("sub/deep/%C3%A4.bin"), "umlau"},
        {NAMES("sub/deep/\xc3\xa4.bin"), "umlau"},
    };
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        struct bytes bytes;
        struct sheen_error error;
        if (pack("part.gltf", good[i].json, &bytes, &error) != SHEEN_OK)
            fail_msg("%s: %s", good[i].json, error.text);
        assert_memory_equal(bytes.data + bytes.size - 8, good[i].bytes, 5);
        free(bytes.data);
    }
}

static void test_outside(void **state)
{
    (void)state;
#define OUTSIDE(uri)                                                                               \
    {                                                                                              \
        NAMES(uri), "part.gltf: buffer 0: '" uri "' is outside of the model's folder, where "      \
                    "nothing is read"                                                              \
    }
#define URL(uri)                                                                                   \
    {                                                                                              \
        NAMES(uri), "part.gltf: buffer 0: '" uri "' is a URL: nothing is fetched"                  \
    }
#define LINK(uri)                                                                                  \
    {                                                                                              \
        NAMES(uri), "part.gltf: buffer 0: '" uri "' is a link to outside of the model's folder"    \
    }
    static const struct {
        const char *json, *text;
    } bad[] = {
        OUTSIDE("../secret.bin"),
        OUTSIDE("%2e%2e/secret.bin"),
        OUTSIDE(".%2E%2Fsecret.bin"),
        OUTSIDE("sub/../../secret.bin"),
        OUTSIDE("sub/../a.bin"),
        OUTSIDE("sub/.."),
        OUTSIDE(".."),
        OUTSIDE("/etc/passwd"),
        OUTSIDE("%2fetc/passwd"),
        OUTSIDE("//host/share/x.bin"),
        LINK("out.bin"),
        LINK("up/secret.bin"),
        LINK("up"),
        URL("http://127.0.0.1/x.bin"),
        URL("https://example.com/x.bin"),
        URL("file:///etc/passwd"),
        URL("file:a.bin"),
        URL("FILE:a.bin"),
        URL("C:/x.bin"),
        URL("blob:x"),
        {NAMES(""), "part.gltf: buffer 0: '' names no file"},
        {NAMES("a.bin%00.png"), "part.gltf: buffer 0: 'a.bin%00.png' holds a zero byte"},
        {NAMES("%00"), "part.gltf: buffer 0: '%00' holds a zero byte"},
        {NAMES("no.bin"), "part.gltf: buffer 0: no.bin: No such file or directory; the model"},
        {NAMES("a.bin/b"), "part.gltf: buffer 0: a.bin/b: Not a directory"},
        {NAMES("loop.bin"), "part.gltf: buffer 0: loop.bin: Too many levels"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        expect_refused(bad[i].json, SHEEN_BAD_MODEL, bad[i].text);
    /* Another folder whose name begins with the name of the model's folder. */
    assert_int_equal(mkdir("../model2", 0700), 0);
    put_file("../model2/x.bin", "12345678", 8);
    assert_int_equal(symlink("../model2/x.bin", "near.bin"), 0);
    expect_refused(NAMES("near.bin"), SHEEN_BAD_MODEL,
                   "part.gltf: buffer 0: 'near.bin' is a link to outside");
    unlink("near.bin");
    unlink("../model2/x.bin");
    rmdir("../model2");
}

static void test_no_files(void **state)
{
    (void)state;
    static const char *const names[] = {"sub", ".", "pipe.bin", "none.bin"};
    static const char *const says[] = {"is not a plain file", "is not a plain file",
                                       "is not a plain file", "is empty"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char json[100];
        struct bytes bytes;
        struct sheen_error error;
        snprintf(json, sizeof json, "{\"buffers\":[{\"byteLength\":5,\"uri\":\"%s\"}]}", names[i]);
        enum sheen_status status = pack("part.gltf", json, &bytes, &error);
        /* "." is the folder itself and not below it. */
        if (status != SHEEN_BAD_MODEL ||
            (!strstr(error.text, says[i]) && !strstr(error.text, "outside")))
            fail_msg("%s: %s", names[i], error.text);
        assert_int_equal(strncmp(error.text, "part.gltf: buffer 0: ", 21), 0);
        free(bytes.data);
    }
}

static void test_layout(void **state)
{
    (void)state;
#define VIEWS(views)                                                                               \
    "{\"buffers\":[{\"byteLength\":8,\"uri\":\"a.bin\"}],\"bufferViews\":[" views "]}"
#define BEYOND "part.gltf: buffer view 1 ends beyond its buffer of 8 bytes"
    static const char *const bad[] = {
        VIEWS("7,{\"buffer\":0,\"byteLength\":9}"),
        VIEWS("7,{\"buffer\":0,\"byteOffset\":8,\"byteLength\":1}"),
        VIEWS("7,{\"buffer\":0,\"byteOffset\":9,\"byteLength\":0}"),
        VIEWS("7,{\"buffer\":0,\"byteOffset\":-1,\"byteLength\":1}"),
        VIEWS("7,{\"buffer\":0,\"byteOffset\":1,\"byteLength\":-1}"),
        VIEWS("7,{\"buffer\":0,\"byteOffset\":9223372036854775807,\"byteLength\":1}"),
        VIEWS("7,{\"buffer\":0,\"byteOffset\":1,\"byteLength\":9223372036854775807}"),
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        expect_refused(bad[i], SHEEN_BAD_MODEL, BEYOND);
    static const char *const numbers[] = {"1.0", "1e0", "\"1\"", "null", "true", "[1]", "{}"};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        char json[200];
        snprintf(json, sizeof json, VIEWS("{\"buffer\":0,\"byteOffset\":%s,\"byteLength\":1}"),
                 numbers[i]);
        expect_refused(json, SHEEN_BAD_MODEL,
                       "part.gltf: buffer view 0: byteOffset is not a whole number");
        snprintf(json, sizeof json, VIEWS("7,{\"buffer\":0,\"byteLength\":%s}"), numbers[i]);
        expect_refused(json, SHEEN_BAD_MODEL,
                       "part.gltf: buffer view 1: byteLength is not a whole number");
    }
    static const char *const lengths[] = {"0", "-5", "1.5", "\"5\"", "null"};
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
        char json[100];
        snprintf(json, sizeof json, "{\"buffers\":[1,{\"byteLength\":%s,\"uri\":\"a.bin\"}]}",
                 lengths[i]);
        expect_refused(json, SHEEN_BAD_MODEL,
                       "part.gltf: buffer 1 has no byteLength, a whole number from 1 up");
    }
    expect_refused("{\"buffers\":[{\"byteLength\":9,\"uri\":\"a.bin\"}]}", SHEEN_BAD_MODEL,
                   "part.gltf: buffer 0 has 9 bytes, but 'a.bin' only 8");
}

/* What other programs write: texts with a zero byte, and integers that no C type holds. */
static void test_texts_and_numbers(void **state)
{
    (void)state;
#define BESIDE(extras)                                                                             \
    "{\"extras\":" extras ",\n\"buffers\":[{\"byteLength\":8,\"uri\":\"a.bin\"}]}"
#define PACKED(extras) "{\"extras\":" extras ",\"buffers\":[{\"byteLength\":8}]}"
    static const char *const good[][2] = {
        {BESIDE("\"a\\u0000b\""), PACKED("\"a\\u0000b\"")},
        {BESIDE("9223372036854775807"), PACKED("9223372036854775807")},
        {BESIDE("-9223372036854775808"), PACKED("-9223372036854775808")},
    };
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        struct bytes bytes, expected = make_glb(good[i][1], "abcdefgh", 8);
        struct sheen_error error;
        if (pack("part.gltf", good[i][0], &bytes, &error) != SHEEN_OK)
            fail_msg("%s", error.text);
        assert_int_equal(bytes.size, expected.size);
        assert_memory_equal(bytes.data, expected.data, bytes.size);
        free(bytes.data);
        free(expected.data);
    }
    expect_refused(BESIDE("\n9223372036854775808"), SHEEN_BAD_MODEL,
                   "part.gltf:2: too big integer near '9223372036854775808'; the files beside it "
                   "cannot be packed");
    expect_refused(BESIDE("-9223372036854775809"), SHEEN_BAD_MODEL,
                   "part.gltf:1: too big negative integer");
    expect_refused("{\"buffers\":[{\"byteLength\":5,\"uri\":\"a.bin\\u0000\"}]}", SHEEN_BAD_MODEL,
                   "part.gltf: buffer 0: its URI holds a zero byte");
}

/* Texts that name no file, valid or not, are passed on as they are; the daemon judges them. */
static void test_unchanged(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "",
        "v 0 0 0\n",
        "{",
        "{}",
        "[]",
        "{\"buffers\":7}",
        "{\"buffers\":[]}",
        "{\"buffers\":[{\"byteLength\":5}]}",
        "{\"buffers\":[{\"byteLength\":5,\"uri\":7}]}",
        "{\"buffers\":[{\"byteLength\":5,\"uri\":\"data:;base64,AAAAAAA=\"}]}",
        "{\"buffers\":[{\"byteLength\":5,\"uri\":\"DATA:x\"}],\"images\":[{\"uri\":\"../x\"}]}",
        "{\"buffers\":[{\"byteLength\":5,\"uri\":\"a.bin\"}]} x",
        "{\"buffers\":[{\"byteLength\":5}],\"extras\":9223372036854775808}",
        "{\"buffers\":[{\"byteLength\":5,\"uri\":\"a.bin\"}],\"extras\":1e999}",
        "glTF",
    };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        expect_unchanged(texts[i]);
    char *deep = malloc(1000001); /* nesting so deep that a recursive parser must limit it */
    assert_non_null(deep);
    memset(deep, '[', 1000000);
    memcpy(deep, "{\"buffers\":", 11);
    deep[1000000] = 0;
    expect_unchanged(deep);
    free(deep);
}

static void test_too_big(void **state)
{
    (void)state;
    static const char text[] = "part.gltf: with the files beside it over 1073741824 bytes";
    put_file("hole.bin", "x", 1);
    off_t most = (off_t)PROTOCOL_MAX_UPLOAD_BYTES;
    assert_int_equal(truncate("hole.bin", most + 1), 0); /* a sparse file, which takes no space */
    expect_refused("{\"buffers\":[{\"byteLength\":5,\"uri\":\"hole.bin\"}]}", SHEEN_TOO_BIG, text);
    /* Each file fits below the limit, but both together do not, though little of them is used. */
    assert_int_equal(truncate("hole.bin", most - 7), 0);
    static const char two[] = "{\"buffers\":[{\"byteLength\":5,\"uri\":\"a.bin\"},"
                              "{\"byteLength\":5,\"uri\":\"hole.bin\"}]}";
    expect_refused(two, SHEEN_TOO_BIG, text);
    assert_int_equal(truncate("hole.bin", 1 << 20), 0);
    struct bytes bytes;
    struct sheen_error error;
    assert_int_equal(pack("part.gltf", two, &bytes, &error), SHEEN_OK);
    assert_memory_equal(bytes.data + bytes.size - 16, "abcde\0\0\0x\0\0\0\0\0\0\0", 16);
    free(bytes.data);
    unlink("hole.bin");
}

/* However the bytes are distributed over files, the cage is that of the single GLB. */
static void test_same_cage(void **state)
{
    (void)state;
    struct bytes glb = make_file(&(struct sample){0});
    struct cage whole, packed;
    struct error failure = {0};
    assert_true(cage_read(&whole, glb.data, glb.size, "part.glb", &failure));
    const unsigned char *chunk = glb.data + glb.size - 96;
    put_file("whole.bin", chunk, 96);
    put_file("rest.bin", chunk + 72, 24);
    free(glb.data);
    static const char *const buffers[] = {
        "{\"byteLength\":96,\"uri\":\"whole.bin\"},{\"byteLength\":24,\"uri\":\"rest.bin\"}",
        "{\"byteLength\":73,\"uri\":\"whole.bin\"},{\"byteLength\":24,\"uri\":\"rest.bin\"}",
        "{\"byteLength\":72,\"uri\":\"whole.bin\"},{\"byteLength\":24,\"uri\":\"data:application/"
        "octet-stream;base64,AAABAAQAAAAEAAMAAQACAAUAAQAFAAQA\"}",
    };
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++) {
        char json[1000];
        snprintf(json, sizeof json,
                 "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{"
                 "\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},"
                 "\"indices\":1,%s}]}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,"
                 "\"type\":\"VEC3\",\"count\":6},{\"bufferView\":1,\"componentType\":5123,\"type\":"
                 "\"SCALAR\",\"count\":12}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":72},{"
                 "\"buffer\":1,\"byteLength\":24}],\"buffers\":[%s]}",
                 NGON, buffers[i]);
        struct bytes bytes;
        struct sheen_error error;
        assert_int_equal(pack("part.gltf", json, &bytes, &error), SHEEN_OK);
        if (!cage_read(&packed, bytes.data, bytes.size, "part.gltf", &failure))
            fail_msg("%s", failure.text);
        assert_int_equal(packed.n_faces, whole.n_faces);
        assert_memory_equal(packed.face_vertex, whole.face_vertex, 8 * sizeof *whole.face_vertex);
        assert_memory_equal(packed.position, whole.position, 6 * sizeof *whole.position);
        assert_null(packed.warnings);
        cage_finish(&packed);
        free(bytes.data);
    }
    cage_finish(&whole);
}

/* sheen_read_file() as programs call it: a .gltf becomes the GLB of gltf_pack(), and every other file
 * comes as it is. */
static void test_read_file(void **state)
{
    (void)state;
    static const char json[] = "{\"buffers\":[{\"byteLength\":8,\"uri\":\"a.bin\"}]}";
    static const char missing[] = "{\"buffers\":[{\"byteLength\":8,\"uri\":\"no.bin\"}]}";
    struct bytes packed;
    struct sheen_error error;
    uint8_t *bytes;
    size_t n_bytes;
    assert_int_equal(pack("part.gltf", json, &packed, &error), SHEEN_OK);
    put_file("whole.bin", json, strlen(json));
    assert_int_equal(sheen_read_file(SHEEN_FILE_MODEL, "whole.bin", &bytes, &n_bytes, &error),
                     SHEEN_OK);
    assert_int_equal(n_bytes, packed.size);
    assert_memory_equal(bytes, packed.data, n_bytes);
    free(bytes);
    free(packed.data);
    assert_int_equal(sheen_read_file(SHEEN_FILE_IMAGE, "whole.bin", &bytes, &n_bytes, NULL),
                     SHEEN_OK);
    assert_int_equal(n_bytes, strlen(json));
    assert_memory_equal(bytes, json, n_bytes);
    free(bytes);

    put_file("whole.bin", missing, strlen(missing));
    assert_int_equal(sheen_read_file(SHEEN_FILE_MODEL, "whole.bin", &bytes, &n_bytes, &error),
                     SHEEN_BAD_MODEL);
    assert_non_null(strstr(error.text, "whole.bin: buffer 0: no.bin: No such file"));
    assert_null(bytes);
    assert_int_equal(n_bytes, 0);
    assert_int_equal(sheen_read_file(SHEEN_FILE_IMAGE, "no.png", &bytes, &n_bytes, &error),
                     SHEEN_BAD_IMAGE);
    assert_null(bytes);

    const int no_kind = 2;
    const struct {
        int kind;
        const char *path;
        uint8_t **bytes;
        size_t *n_bytes;
    } bad[] = {{SHEEN_FILE_MODEL, NULL, &bytes, &n_bytes},
               {SHEEN_FILE_MODEL, "a.bin", NULL, &n_bytes},
               {SHEEN_FILE_MODEL, "a.bin", &bytes, NULL},
               {no_kind, "a.bin", &bytes, &n_bytes}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(sheen_read_file((enum sheen_file_kind)bad[i].kind, bad[i].path,
                                         bad[i].bytes, bad[i].n_bytes, &error),
                         SHEEN_BAD_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bytes),
        cmocka_unit_test(test_names),
        cmocka_unit_test(test_outside),
        cmocka_unit_test(test_no_files),
        cmocka_unit_test(test_layout),
        cmocka_unit_test(test_unchanged),
        cmocka_unit_test(test_too_big),
        cmocka_unit_test(test_same_cage),
        cmocka_unit_test(test_texts_and_numbers),
        cmocka_unit_test(test_read_file),
    };
    return cmocka_run_group_tests_name("client/gltf_pack", tests, setup, teardown);
}
