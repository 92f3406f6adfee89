/* What glTF's extensions mean to a cage: one table. Internal to the glTF reader. Pure; any
 * thread. */
#ifndef SHEEN_CAGE_READ_GLTF_GLTF_EXTENSIONS_H
#define SHEEN_CAGE_READ_GLTF_GLTF_EXTENSIONS_H

#include <stdbool.h>
#include <stddef.h>

#include "server/base/error.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Whether a cage can be read although the file requires the extension text[0, length): it is read,
 * or it cannot change a cage. Else false and ERROR_MODEL, which names it and says what to do. */
bool gltf_extension_check(const char *text, size_t length, const char *name, struct error *error);

/* The extension's name if it packs accessors or buffer views, so that a file that uses it may hold
 * no geometry that can be read without it; else NULL. */
const char *gltf_extension_packing(const char *text, size_t length);

/* Says that geometry is packed by `packing`, and what to do. False. */
bool gltf_extension_refuse_packing(const char *packing, const char *name, struct error *error);

#ifdef __cplusplus
}
#endif

#endif
