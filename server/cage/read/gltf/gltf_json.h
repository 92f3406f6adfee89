/* Checks glTF's JSON, and empties parts of it, before tinygltf reads it. Internal to the glTF reader.
 *
 * tinygltf recurses over nested values, copies the binary chunk for each buffer that names no URI, and
 * spends hundreds of bytes on each value in `extras`: a small hostile file could use up the stack or the
 * memory. These checks bound all three. tinygltf also makes 0 of an offset or stride that is no whole
 * number from 0 up: such files are refused here. And it refuses files for faults in parts that no cage
 * depends on, such as a skin without matrices or an animation whose target is no node: these parts are
 * emptied here. */
#ifndef SHEEN_CAGE_READ_GLTF_GLTF_JSON_H
#define SHEEN_CAGE_READ_GLTF_GLTF_JSON_H

#include <stdbool.h>
#include <stddef.h>

#include "server/base/error.h"

#ifdef __cplusplus
extern "C" {
#endif

struct gltf_json {
    unsigned bare_buffers; /* that name no URI */
    const char *packing;   /* an extension that the file uses and that packs geometry, or NULL */
};

/* Checks text[0, size) as far as said above and changes it in place. Refuses glTF 1.0 and required
 * extensions that are not read by their names: ERROR_MODEL, saying `name`. Pure; any thread. */
bool gltf_json_prepare(struct gltf_json *json, char *text, size_t size, const char *name,
                       struct error *error);

#ifdef __cplusplus
}
#endif

#endif
