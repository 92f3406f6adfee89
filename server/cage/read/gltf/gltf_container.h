/* A glTF file as the library can take it: JSON alone, or a GLB. Internal to the glTF reader.
 *
 * GLB's own header is checked here and gets clear errors, gltf_json_prepare() does the JSON, and
 * both chunks are copied to where the format wants them: some writers do not align them. */
#ifndef SHEEN_CAGE_READ_GLTF_GLTF_CONTAINER_H
#define SHEEN_CAGE_READ_GLTF_GLTF_CONTAINER_H

#include "server/cage/read/gltf/gltf_json.h"

#ifdef __cplusplus
extern "C" {
#endif

struct gltf_container {
    bool binary;          /* GLB */
    bool unaligned;       /* its chunks are not on multiples of 4 bytes in the file */
    unsigned char *bytes; /* for the library; owned */
    unsigned size;
    struct gltf_json json;
};

/* ERROR_MODEL, saying `name`; ERROR_SERVER when memory is short. To be finished in either case.
 * Pure; any thread. */
bool gltf_container_init(struct gltf_container *container, const void *bytes, size_t size,
                         const char *name, struct error *error);

void gltf_container_finish(struct gltf_container *container);

#ifdef __cplusplus
}
#endif

#endif
