#include "client/lib/files/gltf_pack.h"

#include <jansson.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "client/lib/files/relative_file.h"
#include "client/lib/status.h"
#include "protocol/limits.h"

#define GLB_HEADER_BYTES 12u
#define CHUNK_HEADER_BYTES 8u

/* Where the bytes of one buffer are in the GLB. */
struct place {
    json_int_t buffer;
    json_int_t offset;
    json_int_t bytes; /* 0: unchanged, not packed */
};

struct pack {
    const char *path;
    json_t *root;
    size_t n_buffers;
    struct place *place; /* [n_buffers] */
    uint8_t *binary;
    size_t binary_bytes;
    size_t read_bytes; /* size of all files read */
    struct sheen_error *error;
};

static size_t aligned(size_t size)
{
    return (size + 3) / 4 * 4;
}

static enum sheen_status too_big(const struct pack *pack)
{
    return status_set(pack->error, SHEEN_TOO_BIG,
                      "%s: with the files beside it over %llu bytes, which is the most that can be "
                      "uploaded",
                      pack->path, (unsigned long long)PROTOCOL_MAX_UPLOAD_BYTES);
}

/* The URI of a buffer that names a file, or NULL. */
static const char *file_of(const json_t *buffer)
{
    const char *uri = json_string_value(json_object_get(buffer, "uri"));
    return uri && !relative_file_is_data(uri) ? uri : NULL;
}

static enum sheen_status append(struct pack *pack, const uint8_t *bytes, size_t n_bytes)
{
    size_t all = pack->binary_bytes + aligned(n_bytes);
    if (n_bytes > PROTOCOL_MAX_UPLOAD_BYTES || all > PROTOCOL_MAX_UPLOAD_BYTES)
        return too_big(pack);
    uint8_t *grown = realloc(pack->binary, all);
    if (!grown)
        return status_set(pack->error, SHEEN_NO_MEMORY, "%s: no memory for %zu bytes", pack->path,
                          all);
    memcpy(grown + pack->binary_bytes, bytes, n_bytes);
    memset(grown + pack->binary_bytes + n_bytes, 0, all - pack->binary_bytes - n_bytes);
    pack->binary = grown;
    pack->binary_bytes = all;
    return SHEEN_OK;
}

static enum sheen_status add_file(struct pack *pack, size_t index, const json_t *buffer,
                                  const char *uri)
{
    json_int_t wanted = json_integer_value(json_object_get(buffer, "byteLength"));
    if (strlen(uri) != json_string_length(json_object_get(buffer, "uri")))
        return status_set(pack->error, SHEEN_BAD_MODEL, "%s: buffer %zu: its URI holds a zero byte",
                          pack->path, index);
    if (wanted < 1)
        return status_set(pack->error, SHEEN_BAD_MODEL,
                          "%s: buffer %zu has no byteLength, a whole number from 1 up", pack->path,
                          index);
    uint8_t *bytes = NULL;
    size_t n_bytes = 0;
    struct sheen_error inner = {0};
    enum sheen_status status = relative_file_read(
        pack->path, uri, PROTOCOL_MAX_UPLOAD_BYTES - pack->read_bytes, &bytes, &n_bytes, &inner);
    if (status == SHEEN_TOO_BIG)
        return too_big(pack);
    if (status)
        return status_set(pack->error, status, "%s: buffer %zu: %s", pack->path, index, inner.text);
    pack->read_bytes += n_bytes;
    if (pack->read_bytes > PROTOCOL_MAX_UPLOAD_BYTES) { /* the file has grown */
        status = too_big(pack);
    } else if ((uint64_t)wanted > n_bytes) {
        status = status_set(pack->error, SHEEN_BAD_MODEL,
                            "%s: buffer %zu has %lld bytes, but '%.100s' only %zu", pack->path,
                            index, (long long)wanted, uri, n_bytes);
    } else {
        pack->place[index] =
            (struct place){.offset = (json_int_t)pack->binary_bytes, .bytes = wanted};
        status = append(pack, bytes, (size_t)wanted);
    }
    free(bytes);
    return status;
}

/* Reads the files and replaces `buffers` by the buffers of the GLB. */
static enum sheen_status pack_buffers(struct pack *pack, const json_t *buffers)
{
    enum sheen_status status = SHEEN_OK;
    json_t *left = json_array(), *first = json_object();
    bool ok = left && first && json_array_append(left, first) == 0;
    for (size_t i = 0; ok && !status && i < pack->n_buffers; i++) {
        json_t *buffer = json_array_get(buffers, i);
        const char *uri = file_of(buffer);
        if (uri) {
            status = add_file(pack, i, buffer, uri);
        } else {
            pack->place[i] = (struct place){.buffer = (json_int_t)json_array_size(left)};
            ok = json_array_append(left, buffer) == 0;
        }
    }
    if (ok && !status)
        ok = json_object_set_new(first, "byteLength",
                                 json_integer((json_int_t)pack->binary_bytes)) == 0 &&
             json_object_set(pack->root, "buffers", left) == 0;
    json_decref(first);
    json_decref(left);
    return ok || status ? status
                        : status_set(pack->error, SHEEN_NO_MEMORY, "%s: no memory", pack->path);
}

/* Reads a member of a view as a whole number; 0 if it is absent. Refuses anything else, because the
 * value is written back as a number. */
static enum sheen_status whole_number(const struct pack *pack, size_t index, const json_t *view,
                                      const char *key, json_int_t *number)
{
    const json_t *value = json_object_get(view, key);
    *number = json_integer_value(value);
    return !value || json_is_integer(value)
               ? SHEEN_OK
               : status_set(pack->error, SHEEN_BAD_MODEL,
                            "%s: buffer view %zu: %s is not a whole number", pack->path, index,
                            key);
}

static enum sheen_status move_view(struct pack *pack, size_t index, json_t *view)
{
    const json_t *buffer = json_object_get(view, "buffer");
    json_int_t of = json_integer_value(buffer), offset, bytes, end;
    if (!json_is_integer(buffer) || of < 0 || (size_t)of >= pack->n_buffers)
        return SHEEN_OK; /* the reader at the server reports it */
    const struct place *place = &pack->place[of];
    if (place->bytes > 0) {
        enum sheen_status status = whole_number(pack, index, view, "byteOffset", &offset);
        if (!status)
            status = whole_number(pack, index, view, "byteLength", &bytes);
        if (status)
            return status;
        /* The view must lie within its buffer, because other buffers follow now. */
        if (offset < 0 || bytes < 0 || __builtin_add_overflow(offset, bytes, &end) ||
            end > place->bytes)
            return status_set(pack->error, SHEEN_BAD_MODEL,
                              "%s: buffer view %zu ends beyond its buffer of %lld bytes",
                              pack->path, index, (long long)place->bytes);
        if (json_object_set_new(view, "byteOffset", json_integer(place->offset + offset)) != 0)
            return status_set(pack->error, SHEEN_NO_MEMORY, "%s: no memory", pack->path);
    }
    return json_object_set_new(view, "buffer", json_integer(place->buffer)) == 0
               ? SHEEN_OK
               : status_set(pack->error, SHEEN_NO_MEMORY, "%s: no memory", pack->path);
}

static void put_u32(uint8_t *at, size_t value)
{
    for (int i = 0; i < 4; i++)
        at[i] = (uint8_t)(value >> (8 * i));
}

static enum sheen_status write_container(struct pack *pack, uint8_t **bytes, size_t *n_bytes)
{
    size_t text_bytes = json_dumpb(pack->root, NULL, 0, JSON_COMPACT);
    size_t json_bytes = aligned(text_bytes);
    size_t all = GLB_HEADER_BYTES + 2 * CHUNK_HEADER_BYTES + json_bytes + pack->binary_bytes;
    if (json_bytes > PROTOCOL_MAX_UPLOAD_BYTES || all > PROTOCOL_MAX_UPLOAD_BYTES)
        return too_big(pack);
    uint8_t *glb = malloc(all);
    uint8_t *json = glb ? glb + GLB_HEADER_BYTES + CHUNK_HEADER_BYTES : NULL;
    if (text_bytes == 0 || !glb ||
        json_dumpb(pack->root, (char *)json, text_bytes, JSON_COMPACT) != text_bytes) {
        free(glb);
        return status_set(pack->error, SHEEN_NO_MEMORY, "%s: no memory for %zu bytes", pack->path,
                          all);
    }
    memset(json + text_bytes, ' ', json_bytes - text_bytes);
    memcpy(glb, "glTF", 4);
    put_u32(glb + 4, 2);
    put_u32(glb + 8, all);
    put_u32(json - 8, json_bytes);
    memcpy(json - 4, "JSON", 4);
    uint8_t *binary = json + json_bytes + CHUNK_HEADER_BYTES;
    put_u32(binary - 8, pack->binary_bytes);
    memcpy(binary - 4, "BIN", 4);
    memcpy(binary, pack->binary, pack->binary_bytes);
    free(*bytes);
    *bytes = glb;
    *n_bytes = all;
    return SHEEN_OK;
}

static enum sheen_status pack_files(struct pack *pack, const json_t *buffers, uint8_t **bytes,
                                    size_t *n_bytes)
{
    pack->place = calloc(pack->n_buffers, sizeof(*pack->place));
    if (!pack->place)
        return status_set(pack->error, SHEEN_NO_MEMORY, "%s: no memory", pack->path);
    enum sheen_status status = pack_buffers(pack, buffers);
    json_t *views = json_object_get(pack->root, "bufferViews");
    for (size_t i = 0; !status && i < json_array_size(views); i++)
        status = move_view(pack, i, json_array_get(views, i));
    if (!status)
        status = write_container(pack, bytes, n_bytes);
    free(pack->binary);
    free(pack->place);
    return status;
}

static bool names_files(const json_t *root)
{
    const json_t *buffers = json_object_get(root, "buffers");
    for (size_t i = 0; i < json_array_size(buffers); i++)
        if (file_of(json_array_get(buffers, i)))
            return true;
    return false;
}

/* Parses the file's JSON. NULL for other models, and for malformed JSON, which the reader at the
 * server refuses. That reader accepts integers of any length, which cannot be stored here: a file
 * that has one and names other files is refused. */
static enum sheen_status parse(struct pack *pack, const uint8_t *bytes, size_t n_bytes)
{
    size_t at = n_bytes >= 3 && memcmp(bytes, "\xef\xbb\xbf", 3) == 0 ? 3 : 0, start = at;
    while (at < n_bytes && memchr(" \t\r\n", bytes[at], 4))
        at++;
    if (at == n_bytes || bytes[at] != '{')
        return SHEEN_OK;
    json_error_t problem;
    const char *text = (const char *)bytes + start;
    pack->root = json_loadb(text, n_bytes - start, JSON_ALLOW_NUL, &problem);
    if (pack->root || json_error_code(&problem) != json_error_numeric_overflow)
        return SHEEN_OK;
    json_t *inexact =
        json_loadb(text, n_bytes - start, JSON_ALLOW_NUL | JSON_DECODE_INT_AS_REAL, NULL);
    bool needed = names_files(inexact);
    json_decref(inexact);
    return needed ? status_set(pack->error, SHEEN_BAD_MODEL,
                               "%s:%d: %.100s; the files beside it cannot be packed with it",
                               pack->path, problem.line, problem.text)
                  : SHEEN_OK;
}

enum sheen_status gltf_pack(const char *path, uint8_t **bytes, size_t *n_bytes,
                            struct sheen_error *error)
{
    struct pack pack = {.path = path, .error = error};
    enum sheen_status status = parse(&pack, *bytes, *n_bytes);
    const json_t *buffers = json_object_get(pack.root, "buffers");
    pack.n_buffers = json_array_size(buffers);
    if (!status && names_files(pack.root))
        status = pack_files(&pack, buffers, bytes, n_bytes);
    json_decref(pack.root);
    return status;
}
