/* Decides which format a model's file has. Client and daemon use the same rule, so that the client
 * can refuse a file that the daemon would read differently. Pure, any thread. */
#ifndef SHEEN_PROTOCOL_MODEL_FORMAT_H
#define SHEEN_PROTOCOL_MODEL_FORMAT_H

#include <stdbool.h>
#include <stddef.h>
#include <string.h>
#include <strings.h>

/* True if `name` ends with `ending`, ignoring case. */
static inline bool model_format_ends_with(const char *name, const char *ending)
{
    size_t length = strlen(name), n = strlen(ending);
    return length >= n && strcasecmp(name + length - n, ending) == 0;
}

/* True: glTF, as JSON or GLB; false: OBJ. If the name ends with .obj, .gltf or .glb, that decides.
 * Else the contents decide: glTF begins with "glTF", or with '{' after white space. */
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
