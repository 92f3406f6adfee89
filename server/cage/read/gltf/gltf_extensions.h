/* A table of what glTF's extensions mean for a cage. Internal to the glTF reader. Pure, any
 * thread. */
#ifndef SHEEN_CAGE_READ_GLTF_GLTF_EXTENSIONS_H
#define SHEEN_CAGE_READ_GLTF_GLTF_EXTENSIONS_H

#include <stdbool.h>
#include <stddef.h>

#include "server/base/error.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Can a cage be read if the file requires this extension (`length` bytes at `text`)? True if the
 * extension is supported or cannot change a cage. Else false with ERROR_MODEL, which names it and
 * says what to do. */
bool gltf_extension_check(const char *text, size_t length, const char *name, struct error *error);

/* The extension's name if it packs accessors or buffer views, so that a file that uses it may have
 * no geometry that is readable without it; else NULL. */
const char *gltf_extension_packing(const char *text, size_t length);

/* Sets the error that geometry is packed by `packing`, and what to do. Returns false. */
bool gltf_extension_refuse_packing(const char *packing, const char *name, struct error *error);

#ifdef __cplusplus
}
#endif

#endif
