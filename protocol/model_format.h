/* Which format a model's file is in. The rule is the same on both sides: the client refuses by it
 * what the daemon would read otherwise. Pure functions, any thread. */
#ifndef SHEEN_PROTOCOL_MODEL_FORMAT_H
#define SHEEN_PROTOCOL_MODEL_FORMAT_H

#include <stdbool.h>
#include <stddef.h>
#include <string.h>
#include <strings.h>

/* Whether `name` ends in `ending`, in capitals or not. */
static inline bool model_format_ends_with(const char *name, const char *ending)
{
    size_t length = strlen(name), n = strlen(ending);
    return length >= n && strcasecmp(name + length - n, ending) == 0;
}

/* True: glTF, in JSON or as GLB; false: OBJ. An ending .obj, .gltf or .glb of the name decides;
 * where it has another or none the bytes[0, size) do: those of glTF begin with "glTF", or after
 * blanks with '{'. */
static inline bool model_format_is_gltf(const char *name, const void *bytes, size_t size)
{
    const char *text = bytes;
    size_t at = 0;
    if (model_format_ends_with(name, ".obj"))
        return false;
    if (model_format_ends_with(name, ".gltf") || model_format_ends_with(name, ".glb"))
        return true;
    if (size >= 4 && memcmp(text, "glTF", 4) == 0)
        return true;
    while (at < size && text[at] && strchr(" \t\r\n", text[at]))
        at++;
    return at < size && text[at] == '{';
}

#endif
