#include "server/cage/read/gltf_container.h"

#include <limits.h>
#include <stdint.h>
#include <string.h>

#define MAX_JSON_DEPTH 64
#define MAX_JSON_VALUES 4000000u
/* Each buffer without a URI is the binary chunk again; the format means one. */
#define MAX_BUFFERS_BESIDE_CHUNK 4u

#define GLB_HEADER_BYTES 20u /* magic, version, length, and the first chunk's length and type */
#define GLB_CHUNK_JSON 0x4e4f534au
#define GLB_CHUNK_BIN 0x004e4942u

static uint32_t read_u32(const unsigned char *at)
{
    return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

/* Arrays of the top level. */
enum json_part { PART_OTHER, PART_BUFFERS, PART_VIEWS, PART_ACCESSORS, N_PARTS };

static const struct {
    const char *key, *element;
} PARTS[N_PARTS] = {[PART_OTHER] = {"", ""},
                    [PART_BUFFERS] = {"buffers", "buffer"},
                    [PART_VIEWS] = {"bufferViews", "buffer view"},
                    [PART_ACCESSORS] = {"accessors", "accessor"}};

struct json_scan {
    const char *at, *end;
    int depth;
    unsigned values;
    enum json_part part; /* that `at` is in */
    unsigned objects[N_PARTS];
};

struct json_text {
    const char *start;
    size_t length;
    bool escaped;
};

static bool is_text(const struct json_text *text, const char *other)
{
    return text->length == strlen(other) && memcmp(text->start, other, text->length) == 0;
}

/* From the opening quote to past the closing one. */
static struct json_text scan_string(struct json_scan *scan)
{
    struct json_text text = {.start = ++scan->at};
    while (scan->at < scan->end && *scan->at != '"') {
        text.escaped |= *scan->at == '\\';
        scan->at += *scan->at == '\\' && scan->at + 1 < scan->end ? 2 : 1;
    }
    text.length = (size_t)(scan->at - text.start);
    if (scan->at < scan->end)
        scan->at++;
    return text;
}

static const char *skip_blanks(const char *at, const char *end)
{
    while (at < end && memchr(" \t\r\n", *at, 4))
        at++;
    return at;
}

/* A whole number below 2^64: of what else stands there tinygltf makes 0 without a word. */
static bool is_unsigned(const char *at, const char *end)
{
    const char *first = at;
    uint64_t number = 0;
    for (; at < end && *at >= '0' && *at <= '9'; at++)
        if (__builtin_mul_overflow(number, 10, &number) ||
            __builtin_add_overflow(number, (uint64_t)(*at - '0'), &number))
            return false;
    return at > first && !(at < end && memchr(".eE", *at, 3));
}

/* What has been scanned may be a key of a buffer view or accessor, before its value. */
static bool check_layout(const struct json_scan *scan, const struct json_text *key,
                         const char *name, struct error *error)
{
    const char *at = skip_blanks(scan->at, scan->end);
    const char *element = PARTS[scan->part].element;
    unsigned index = scan->objects[scan->part] - 1;
    if (at == scan->end || *at != ':')
        return true;
    if (key->escaped)
        return error_set(error, ERROR_MODEL, "%s: a key of %s %u is spelt with escapes", name,
                         element, index);
    at = skip_blanks(at + 1, scan->end);
    if ((!is_text(key, "byteOffset") && !is_text(key, "byteStride")) || is_unsigned(at, scan->end))
        return true;
    int shown = 0;
    while (at + shown < scan->end && shown < 24 && !strchr(" \t\r\n,]}", at[shown]))
        shown++;
    return error_set(error, ERROR_MODEL,
                     "%s: %s %u: %.*s is %.*s; it must be a whole number from "
                     "0 up",
                     name, element, index, (int)key->length, key->start, shown, at);
}

/* Keys that are looked for must be spelt plainly, so that they can be told. */
static bool check_string(struct json_scan *scan, const struct json_text *text, const char *name,
                         struct error *error)
{
    if (scan->depth == 3 && (scan->part == PART_VIEWS || scan->part == PART_ACCESSORS))
        return check_layout(scan, text, name, error);
    if (scan->depth != 1)
        return true;
    scan->part = N_PARTS - 1;
    while (scan->part > PART_OTHER && !is_text(text, PARTS[scan->part].key))
        scan->part--;
    return !text->escaped ||
           error_set(error, ERROR_MODEL, "%s: a top-level key of the JSON is spelt with escapes",
                     name);
}

static bool scan_json(struct json_scan *scan, const char *name, struct error *error)
{
    while (scan->at < scan->end) {
        char c = *scan->at;
        if (c == '"') {
            struct json_text text = scan_string(scan);
            if (!check_string(scan, &text, name, error))
                return false;
            continue;
        }
        if (c == '{' || c == '[') {
            if (++scan->depth > MAX_JSON_DEPTH)
                return error_set(error, ERROR_MODEL, "%s: JSON nested deeper than %d levels", name,
                                 MAX_JSON_DEPTH);
            scan->objects[scan->part] += scan->depth == 3;
        } else if (c == '}' || c == ']') {
            scan->depth--;
        }
        if ((c == ',' || c == '[') && ++scan->values > MAX_JSON_VALUES)
            return error_set(error, ERROR_MODEL,
                             "%s: more than %u values in the JSON: keep geometry in buffers", name,
                             MAX_JSON_VALUES);
        scan->at++;
    }
    return true;
}

static bool check_glb_header(const unsigned char *bytes, size_t size, const char *name,
                             struct error *error)
{
    if (size < GLB_HEADER_BYTES)
        return error_set(error, ERROR_MODEL,
                         "%s: truncated: a GLB has at least %u bytes, the file has %zu", name,
                         GLB_HEADER_BYTES, size);
    uint32_t version = read_u32(bytes + 4), length = read_u32(bytes + 8);
    uint32_t json_length = read_u32(bytes + 12), json_type = read_u32(bytes + 16);
    if (version != 2)
        return error_set(error, ERROR_MODEL, "%s: GLB version %u, only version 2 is read", name,
                         version);
    if (length > size)
        return error_set(error, ERROR_MODEL,
                         "%s: truncated: its header says %u bytes, the file has %zu", name, length,
                         size);
    if (json_type != GLB_CHUNK_JSON)
        return error_set(error, ERROR_MODEL, "%s: the first chunk of the GLB is not JSON", name);
    if (length < GLB_HEADER_BYTES || json_length > length - GLB_HEADER_BYTES)
        return error_set(error, ERROR_MODEL,
                         "%s: the JSON chunk says %u bytes, but the GLB ends after %u", name,
                         json_length, length - (length < GLB_HEADER_BYTES ? 0 : GLB_HEADER_BYTES));
    uint32_t left = length - GLB_HEADER_BYTES - json_length;
    const unsigned char *chunk = bytes + GLB_HEADER_BYTES + json_length;
    if (left == 0)
        return true;
    if (left < 8 || read_u32(chunk + 4) != GLB_CHUNK_BIN)
        return error_set(error, ERROR_MODEL, "%s: the second chunk of the GLB is not BIN", name);
    if (read_u32(chunk) > left - 8)
        return error_set(error, ERROR_MODEL,
                         "%s: the BIN chunk says %u bytes, but only %u are left in the GLB", name,
                         read_u32(chunk), left - 8);
    return true;
}

bool gltf_container_check(struct gltf_container *container, const void *bytes, size_t size,
                          const char *name, struct error *error)
{
    const unsigned char *start = bytes;
    if (size > INT_MAX)
        return error_set(error, ERROR_MODEL, "%s: glTF files beyond 2 GB are not read", name);
    *container = (struct gltf_container){.length = (unsigned)size};
    struct json_scan scan = {.at = bytes, .end = (const char *)bytes + size};
    if (size >= 4 && memcmp(bytes, "glTF", 4) == 0) {
        if (!check_glb_header(start, size, name, error))
            return false;
        container->binary = true;
        container->length = read_u32(start + 8);
        scan.at += GLB_HEADER_BYTES;
        scan.end = scan.at + read_u32(start + 12);
    }
    if (!scan_json(&scan, name, error))
        return false;
    if (container->binary && scan.objects[PART_BUFFERS] > MAX_BUFFERS_BESIDE_CHUNK)
        return error_set(error, ERROR_MODEL, "%s: %u buffers in a GLB, at most %u are read", name,
                         scan.objects[PART_BUFFERS], MAX_BUFFERS_BESIDE_CHUNK);
    return true;
}
