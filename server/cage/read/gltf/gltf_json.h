/* Checks the JSON of glTF, and empties parts of it, before tinygltf reads it. Internal to the glTF
 * reader.
 *
 * tinygltf recurses over nested values, copies the binary chunk for each buffer without a URI, and
 * spends hundreds of bytes on each value in `extras`: a small hostile file could exhaust the stack
 * or the memory. These checks bound all three. tinygltf also reads an offset or stride that is not
 * a whole number from 0 on as 0: such files are refused. And tinygltf refuses files for faults in
 * parts that cannot change a cage, such as a skin without matrices or an animation without a
 * target: these parts are emptied. */
#ifndef SHEEN_CAGE_READ_GLTF_GLTF_JSON_H
#define SHEEN_CAGE_READ_GLTF_GLTF_JSON_H

#include <stdbool.h>
#include <stddef.h>

#include "server/base/error.h"

#ifdef __cplusplus
extern "C" {
#endif

struct gltf_json {
    unsigned bare_buffers; /* number of buffers without a URI */
    const char *packing;   /* an extension of the file that packs geometry, or NULL */
};

/* Checks `size` bytes of `text` and changes them in place, as described above. Refuses glTF 1.0,
 * and required extensions that are not supported: false with ERROR_MODEL, which names `name`. Pure,
 * any thread. */
bool gltf_json_prepare(struct gltf_json *json, char *text, size_t size, const char *name,
                       struct error *error);

#ifdef __cplusplus
}
#endif

#endif
