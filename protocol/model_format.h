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

enum model_format {
    MODEL_OBJ,
    MODEL_GLTF,    /* as JSON or GLB */
    MODEL_USD,     /* in any form; only the text form can be read */
    MODEL_BPT,     /* Bezier patches */
    MODEL_PATCHES, /* sheen's own form of patches */
};

/* True if the ending of the name tells the format, which is then in *format. */
static inline bool model_format_of_name(const char *name, enum model_format *format)
{
    static const struct {
        const char *ending;
        enum model_format format;
    } known[] = {
        {".obj", MODEL_OBJ},  {".gltf", MODEL_GLTF}, {".glb", MODEL_GLTF},
        {".usda", MODEL_USD}, {".usd", MODEL_USD},   {".usdc", MODEL_USD},
        {".usdz", MODEL_USD}, {".bpt", MODEL_BPT},   {".patches", MODEL_PATCHES},
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        if (model_format_ends_with(name, known[i].ending)) {
            *format = known[i].format;
            return true;
        }
    }
    return false;
}

/* The ending of the name decides if it is known; else the contents decide. glTF begins with "glTF",
 * or with '{' after white space; USD with "#usda" or "PXR-USDC"; .bpt with a digit and .patches
 * with "patches", after white space; the rest is OBJ. */
static inline enum model_format model_format(const char *name, const void *bytes, size_t size)
{
    const char *text = bytes;
    size_t at = 0;
    enum model_format format;
    if (model_format_of_name(name, &format))
        return format;
    if (size >= 4 && memcmp(text, "glTF", 4) == 0)
        return MODEL_GLTF;
    if ((size >= 5 && memcmp(text, "#usda", 5) == 0) ||
        (size >= 8 && memcmp(text, "PXR-USDC", 8) == 0))
        return MODEL_USD;
    while (at < size && text[at] && strchr(" \t\r\n", text[at]))
        at++;
    if (size - at >= 8 && memcmp(text + at, "patches", 7) == 0)
        return MODEL_PATCHES;
    if (at < size && text[at] >= '0' && text[at] <= '9')
        return MODEL_BPT;
    return at < size && text[at] == '{' ? MODEL_GLTF : MODEL_OBJ;
}

#endif
