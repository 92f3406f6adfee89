/* Which parts of a glTF file are read and which are passed over: nodes, scenes, primitives, extensions,
 * versions, and the chunks of a GLB. */
#include "server/cage/read/read.h"
#include "tests/unit/gltf_sample.h"

#define GRID_ACCESSOR "{\"bufferView\":0,\"componentType\":5126,\"type\":\"VEC3\",\"count\":6}"
#define PAIR_ACCESSOR "{\"bufferView\":1,\"componentType\":5123,\"type\":\"SCALAR\",\"count\":12}"

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
    /* tinygltf would refuse each of these, or would read beyond the file because of it. */
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
    /* A broken member ends at its closing bracket, not later. */
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
    /* An extension that is used but not required is refused only if data is missing without it. */
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
    /* A buffer without URI and bytes, which only packed views replace, holds no data. */
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

/* Chunks of any length: with padding that the header counts, and with padding that it does not
 * count. */
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
        cmocka_unit_test(test_passed_over),      cmocka_unit_test(test_points_and_lines),
        cmocka_unit_test(test_hidden_nodes),     cmocka_unit_test(test_scenes),
        cmocka_unit_test(test_extensions),       cmocka_unit_test(test_first_version),
        cmocka_unit_test(test_unaligned_chunks),
    };
    return cmocka_run_group_tests_name("cage/gltf_parts", tests, NULL, NULL);
}
