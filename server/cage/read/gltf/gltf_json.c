#include "server/cage/read/gltf/gltf_json.h"

#include <limits.h>
#include <stdint.h>
#include <string.h>

#include "server/cage/read/gltf/gltf_extensions.h"

#define MAX_JSON_DEPTH 64
#define MAX_JSON_VALUES 4000000u

/* Members of the top level. */
enum json_part {
    PART_OTHER,
    PART_ASSET,
    PART_USED,
    PART_REQUIRED,
    PART_MESHES,
    PART_BUFFERS,
    PART_VIEWS,
    PART_ACCESSORS,
    PART_PASSED_OVER, /* cannot change a cage */
};

static const struct {
    const char *key;
    enum json_part part;
    const char *element; /* name of one element in messages; NULL: its keys are not checked */
} PARTS[] = {
    {"asset", PART_ASSET, NULL},
    {"extensionsUsed", PART_USED, NULL},
    {"extensionsRequired", PART_REQUIRED, NULL},
    {"meshes", PART_MESHES, NULL},
    {"buffers", PART_BUFFERS, "buffer"},
    {"bufferViews", PART_VIEWS, "buffer view"},
    {"accessors", PART_ACCESSORS, "accessor"},
    {"animations", PART_PASSED_OVER, NULL},
    {"cameras", PART_PASSED_OVER, NULL},
    {"extensions", PART_PASSED_OVER, NULL},
    {"images", PART_PASSED_OVER, NULL},
    {"materials", PART_PASSED_OVER, NULL},
    {"samplers", PART_PASSED_OVER, NULL},
    {"skins", PART_PASSED_OVER, NULL},
    {"textures", PART_PASSED_OVER, NULL},
};

enum { N_PARTS = sizeof PARTS / sizeof *PARTS };

struct json_scan {
    char *at, *end;
    int depth;
    unsigned values;
    enum json_part part; /* that `at` is in */
    const char *element; /* from PARTS */
    unsigned n_elements; /* elements of the part so far */
    char *passed_over;   /* first byte inside of the brackets of a PART_PASSED_OVER */
    bool in_sparse;      /* `at` is inside of an accessor's `sparse` */
    bool has_uri;        /* the buffer that contains `at` has a URI */
    struct gltf_json *json;
    const char *name;
    struct error *error;
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

/* Scans a string, from the opening quote to behind the closing one. */
static struct json_text scan_string(struct json_scan *scan)
{
    char *start = ++scan->at;
    struct json_text text = {.start = start};
    while (scan->at < scan->end && *scan->at != '"') {
        text.escaped |= *scan->at == '\\';
        scan->at += *scan->at == '\\' && scan->at + 1 < scan->end ? 2 : 1;
    }
    text.length = (size_t)(scan->at - start);
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

/* The value behind a key that was just scanned; NULL: it was not a key. */
static const char *value_of_key(const struct json_scan *scan)
{
    const char *at = skip_blanks(scan->at, scan->end);
    return at < scan->end && *at == ':' ? skip_blanks(at + 1, scan->end) : NULL;
}

/* True if the value is a whole number from 0 to `most`. tinygltf reads anything else as 0, without
 * a message. */
static bool is_unsigned(const char *at, const char *end, uint64_t most)
{
    const char *first = at;
    uint64_t number = 0;
    for (; at < end && *at >= '0' && *at <= '9'; at++)
        if (__builtin_mul_overflow(number, 10, &number) ||
            __builtin_add_overflow(number, (uint64_t)(*at - '0'), &number))
            return false;
    return at > first && number <= most && !(at < end && memchr(".eE", *at, 3));
}

static bool check_offset(const struct json_scan *scan, const struct json_text *key, const char *at)
{
    /* tinygltf stores offsets of sparse accessors in an int. */
    uint64_t most = scan->depth == 3 ? UINT64_MAX : INT_MAX;
    if ((!is_text(key, "byteOffset") && !is_text(key, "byteStride")) ||
        is_unsigned(at, scan->end, most))
        return true;
    int shown = 0;
    while (at + shown < scan->end && shown < 24 && !strchr(" \t\r\n,]}", at[shown]))
        shown++;
    return error_set(scan->error, ERROR_MODEL,
                     "%s: %s %u: %.*s is %.*s; it must be a whole number from "
                     "0 up",
                     scan->name, scan->element, scan->n_elements - 1, (int)key->length, key->start,
                     shown, at);
}

/* Checks the scanned text, which may be a key of a buffer, buffer view or accessor. */
static bool check_layout(struct json_scan *scan, const struct json_text *key)
{
    const char *value = value_of_key(scan);
    if (!value)
        return true;
    if (key->escaped)
        return error_set(scan->error, ERROR_MODEL, "%s: a key of %s %u is spelt with escapes",
                         scan->name, scan->element, scan->n_elements - 1);
    if (scan->depth == 3)
        scan->in_sparse = scan->part == PART_ACCESSORS && is_text(key, "sparse");
    if (scan->part == PART_BUFFERS && is_text(key, "uri"))
        scan->has_uri = scan->end - value >= 2 && value[0] == '"' && value[1] != '"';
    return scan->part == PART_BUFFERS || check_offset(scan, key, value);
}

static bool refuse_first_version(const struct json_scan *scan)
{
    return error_set(scan->error, ERROR_MODEL, "%s: glTF 1.0; only 2.0 is read: export it as 2.0",
                     scan->name);
}

static bool check_asset(const struct json_scan *scan, const struct json_text *key)
{
    const char *value = value_of_key(scan);
    if (!value || !is_text(key, "version"))
        return true;
    value += value < scan->end && *value == '"';
    if (scan->end - value >= 2 && value[0] == '1' && memchr(".\",} ", value[1], 5))
        return refuse_first_version(scan);
    return true;
}

static bool check_extension(struct json_scan *scan, const struct json_text *text)
{
    if (text->escaped)
        return error_set(scan->error, ERROR_MODEL,
                         "%s: the name of an extension is spelt with escapes", scan->name);
    if (!scan->json->packing)
        scan->json->packing = gltf_extension_packing(text->start, text->length);
    return scan->part == PART_USED ||
           gltf_extension_check(text->start, text->length, scan->name, scan->error);
}

/* Keys must be written without escapes, so that the ones searched for are recognised. */
static bool enter_part(struct json_scan *scan, const struct json_text *key)
{
    scan->part = PART_OTHER;
    scan->element = NULL;
    scan->n_elements = 0;
    for (size_t i = 0; i < N_PARTS; i++) {
        if (is_text(key, PARTS[i].key)) {
            scan->part = PARTS[i].part;
            scan->element = PARTS[i].element;
        }
    }
    return !key->escaped ||
           error_set(scan->error, ERROR_MODEL,
                     "%s: a top-level key of the JSON is spelt with escapes", scan->name);
}

static bool check_string(struct json_scan *scan, const struct json_text *text)
{
    if (scan->depth == 1)
        return enter_part(scan, text);
    if (scan->depth == 2 && scan->part == PART_ASSET)
        return check_asset(scan, text);
    if (scan->depth == 2 && (scan->part == PART_USED || scan->part == PART_REQUIRED))
        return check_extension(scan, text);
    if (scan->element && (scan->depth == 3 || (scan->depth == 5 && scan->in_sparse)))
        return check_layout(scan, text);
    return true;
}

static bool open_bracket(struct json_scan *scan)
{
    if (++scan->depth > MAX_JSON_DEPTH)
        return error_set(scan->error, ERROR_MODEL, "%s: JSON nested deeper than %d levels",
                         scan->name, MAX_JSON_DEPTH);
    if (scan->depth == 2) {
        scan->passed_over = scan->part == PART_PASSED_OVER ? scan->at + 1 : NULL;
        if (scan->part == PART_MESHES && *scan->at == '{')
            return refuse_first_version(scan);
    }
    if (scan->depth == 3) {
        scan->n_elements++;
        scan->in_sparse = scan->has_uri = false;
    }
    return true;
}

static void close_bracket(struct json_scan *scan)
{
    if (scan->depth == 3 && scan->part == PART_BUFFERS && !scan->has_uri)
        scan->json->bare_buffers++;
    if (scan->depth == 2 && scan->passed_over) {
        memset(scan->passed_over, ' ', (size_t)(scan->at - scan->passed_over));
        scan->passed_over = NULL;
    }
    scan->depth--;
}

bool gltf_json_prepare(struct gltf_json *json, char *text, size_t size, const char *name,
                       struct error *error)
{
    *json = (struct gltf_json){0};
    struct json_scan scan = {
        .at = text, .end = text + size, .json = json, .name = name, .error = error};
    while (scan.at < scan.end) {
        char c = *scan.at;
        if (c == '"') {
            struct json_text string = scan_string(&scan);
            if (!check_string(&scan, &string))
                return false;
            continue;
        }
        if ((c == '{' || c == '[') && !open_bracket(&scan))
            return false;
        if (c == '}' || c == ']')
            close_bracket(&scan);
        if ((c == ',' || c == '[') && ++scan.values > MAX_JSON_VALUES)
            return error_set(error, ERROR_MODEL,
                             "%s: more than %u values in the JSON: keep geometry in buffers", name,
                             MAX_JSON_VALUES);
        scan.at++;
    }
    return true;
}
