#include "server/cage/read/gltf/gltf_extensions.h"

#include <string.h>

enum kind {
    READ,
    PASSED_OVER, /* about appearance, motion, sound, physics or metadata: cannot change a cage */
    PACKING,     /* packs vertices and faces, which are not readable without it */
};

/* A name that ends with '*' stands for all names with that prefix. A required extension that is not
 * in the table is refused. */
static const struct {
    const char *name;
    enum kind kind;
} EXTENSIONS[] = {
    {"FB_ngon_encoding", READ},
    {"EXT_mesh_gpu_instancing", READ},
    {"KHR_mesh_quantization", READ},
    {"KHR_node_visibility", READ},

    {"KHR_draco_mesh_compression", PACKING},
    {"EXT_meshopt_compression", PACKING},
    {"KHR_meshopt_compression", PACKING},

    {"KHR_materials_*", PASSED_OVER},
    {"EXT_materials_*", PASSED_OVER},
    {"ADOBE_materials_*", PASSED_OVER},
    {"MSFT_packing_*", PASSED_OVER}, /* textures */
    {"NV_materials_mdl", PASSED_OVER},
    {"KHR_techniques_webgl", PASSED_OVER},
    {"KHR_texture_*", PASSED_OVER},
    {"EXT_texture_*", PASSED_OVER},
    {"MSFT_texture_dds", PASSED_OVER},
    {"KHR_lights_*", PASSED_OVER},
    {"EXT_lights_*", PASSED_OVER},
    {"KHR_environment_map", PASSED_OVER},
    {"CESIUM_primitive_outline", PASSED_OVER},
    {"KHR_animation_pointer", PASSED_OVER},
    {"KHR_interactivity", PASSED_OVER},
    {"KHR_node_selectability", PASSED_OVER},
    {"KHR_node_hoverability", PASSED_OVER},
    {"KHR_audio*", PASSED_OVER},
    {"MSFT_audio_emitter", PASSED_OVER},
    {"KHR_implicit_shapes", PASSED_OVER},
    {"KHR_physics_rigid_bodies", PASSED_OVER},
    {"OMI_*", PASSED_OVER},
    {"MSFT_lod", PASSED_OVER},
    {"AGI_articulations", PASSED_OVER},
    {"AGI_stk_metadata", PASSED_OVER},
    {"KHR_xmp", PASSED_OVER},
    {"KHR_xmp_json_ld", PASSED_OVER},
    {"EXT_mesh_features", PASSED_OVER},
    {"EXT_instance_features", PASSED_OVER},
    {"EXT_structural_metadata", PASSED_OVER},
    {"FB_geometry_metadata", PASSED_OVER},
    {"GRIFFEL_bim_data", PASSED_OVER},
    {"VRM", PASSED_OVER},
    {"VRMC_*", PASSED_OVER},
};

enum { N_EXTENSIONS = sizeof EXTENSIONS / sizeof *EXTENSIONS };

static bool matches(const char *pattern, const char *text, size_t length)
{
    size_t n = strlen(pattern);
    if (pattern[n - 1] == '*')
        return length >= n - 1 && memcmp(text, pattern, n - 1) == 0;
    return length == n && memcmp(text, pattern, n) == 0;
}

/* Returns N_EXTENSIONS if it is not in the table. */
static size_t find(const char *text, size_t length)
{
    size_t i = 0;
    while (i < N_EXTENSIONS && !matches(EXTENSIONS[i].name, text, length))
        i++;
    return i;
}

const char *gltf_extension_packing(const char *text, size_t length)
{
    size_t i = find(text, length);
    return i < N_EXTENSIONS && EXTENSIONS[i].kind == PACKING ? EXTENSIONS[i].name : NULL;
}

bool gltf_extension_refuse_packing(const char *packing, const char *name, struct error *error)
{
    return error_set(error, ERROR_MODEL,
                     "%s: its geometry is packed with %s, which is not read: export it without "
                     "compression",
                     name, packing);
}

bool gltf_extension_check(const char *text, size_t length, const char *name, struct error *error)
{
    const char *packing = gltf_extension_packing(text, length);
    if (packing)
        return gltf_extension_refuse_packing(packing, name, error);
    return find(text, length) < N_EXTENSIONS ||
           error_set(error, ERROR_MODEL,
                     "%s: it requires the extension '%.*s', which is not read: export it without",
                     name, (int)(length < 60 ? length : 60), text);
}
