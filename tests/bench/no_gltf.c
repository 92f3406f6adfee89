/* Replaces the glTF reader in a program that must not need tinygltf. */
#include "server/cage/read/gltf/gltf.h"

bool gltf_read(struct cage_builder *builder, const void *bytes, size_t size, const char *name,
               struct error *error)
{
    (void)builder, (void)bytes, (void)size;
    return error_set(error, ERROR_MODEL,
                     "%s: this program reads OBJ alone: give it the cage as OBJ", name);
}
