/* Prepares a glTF file for the library: JSON alone, or a GLB. Internal to the glTF reader.
 *
 * The GLB header is checked here, with clear errors; gltf_json_prepare() checks the JSON. Both
 * chunks are copied to the alignment that the format demands, because some programs do not align
 * them. */
#ifndef SHEEN_CAGE_READ_GLTF_GLTF_CONTAINER_H
#define SHEEN_CAGE_READ_GLTF_GLTF_CONTAINER_H

#include "server/cage/read/gltf/gltf_json.h"

#ifdef __cplusplus
extern "C" {
#endif

struct gltf_container {
    bool binary;          /* GLB */
    bool unaligned;       /* its chunks are not aligned to 4 bytes in the file */
    unsigned char *bytes; /* the file for the library; owned */
    unsigned size;
    struct gltf_json json;
};

/* False with ERROR_MODEL, which names `name`, or with ERROR_SERVER when memory is short. Call
 * gltf_container_finish() in both cases. Pure, any thread. */
bool gltf_container_init(struct gltf_container *container, const void *bytes, size_t size,
                         const char *name, struct error *error);

void gltf_container_finish(struct gltf_container *container);

#ifdef __cplusplus
}
#endif

#endif
