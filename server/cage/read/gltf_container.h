/* What is checked of a glTF file before a JSON library sees it. Internal to the glTF reader.
 *
 * tinygltf recurses over nested values, copies the binary chunk for each buffer that names no
 * URI, and spends hundreds of bytes on each value in `extras`: a small hostile file could take
 * the stack or the memory. It also takes an offset or stride that is no whole number from 0 up for
 * 0. These checks bound the former three, refuse the latter, and give GLB's own header clear
 * errors. */
#ifndef SHEEN_CAGE_READ_GLTF_CONTAINER_H
#define SHEEN_CAGE_READ_GLTF_CONTAINER_H

#include <stdbool.h>
#include <stddef.h>

#include "server/error.h"

#ifdef __cplusplus
extern "C" {
#endif

struct gltf_container {
    bool binary;     /* GLB */
    unsigned length; /* bytes to hand to the library: GLB's own length, or the whole file */
};

/* ERROR_MODEL, saying `name`. Pure; any thread. */
bool gltf_container_check(struct gltf_container *container, const void *bytes, size_t size,
                          const char *name, struct error *error);

#ifdef __cplusplus
}
#endif

#endif
