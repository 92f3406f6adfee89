#include "server/cage/read/gltf/gltf_container.h"

#include <limits.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* The library copies the binary chunk for every buffer without a URI; the format allows one such
 * buffer. */
#define MAX_BUFFERS_BESIDE_CHUNK 4u

#define GLB_HEADER_BYTES 20u /* magic, version, length, and the first chunk's length and type */
#define GLB_CHUNK_BYTES 8u   /* a chunk's length and type */
#define GLB_CHUNK_JSON 0x4e4f534au
#define GLB_CHUNK_BIN 0x004e4942u

static uint32_t read_u32(const unsigned char *at)
{
    return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static void write_u32(unsigned char *at, size_t value)
{
    for (int i = 0; i < 4; i++)
        at[i] = (unsigned char)(value >> (8 * i));
}

static size_t aligned(size_t size)
{
    return (size + 3) / 4 * 4;
}

struct chunks {
    const unsigned char *json, *bin;
    size_t json_size, bin_size; /* bin_size 0: no binary chunk */
};

static bool find_binary_chunk(struct chunks *chunks, const unsigned char *end, const char *name,
                              struct error *error)
{
    const unsigned char *chunk = chunks->json + chunks->json_size;
    size_t left = (size_t)(end - chunk), skip = aligned(chunks->json_size) - chunks->json_size;
    if (left <= skip)
        return true;
    /* Some programs pad the chunk without counting the padding. */
    if (left >= skip + GLB_CHUNK_BYTES && read_u32(chunk + 4) != GLB_CHUNK_BIN &&
        read_u32(chunk + skip + 4) == GLB_CHUNK_BIN) {
        chunk += skip;
        left -= skip;
    }
    if (left < GLB_CHUNK_BYTES || read_u32(chunk + 4) != GLB_CHUNK_BIN)
        return error_set(error, ERROR_MODEL, "%s: the second chunk of the GLB is not BIN", name);
    left -= GLB_CHUNK_BYTES;
    chunks->bin = chunk + GLB_CHUNK_BYTES;
    chunks->bin_size = read_u32(chunk);
    return chunks->bin_size <= left ||
           error_set(error, ERROR_MODEL,
                     "%s: the BIN chunk says %zu bytes, but only %zu are left in the GLB", name,
                     chunks->bin_size, left);
}

static bool find_chunks(struct chunks *chunks, const unsigned char *bytes, size_t size,
                        const char *name, struct error *error)
{
    if (size >= 8 && read_u32(bytes + 4) == 1)
        return error_set(error, ERROR_MODEL,
                         "%s: glTF 1.0 (GLB version 1); only 2.0 is read: export it as 2.0", name);
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
    chunks->json = bytes + GLB_HEADER_BYTES;
    chunks->json_size = json_length;
    return find_binary_chunk(chunks, bytes + length, name, error);
}

/* Copies the JSON to `to`, followed by blanks. */
static void copy_json(unsigned char *to, const struct chunks *chunks)
{
    memcpy(to, chunks->json, chunks->json_size);
    memset(to + chunks->json_size, ' ', aligned(chunks->json_size) - chunks->json_size);
}

static void copy_glb(unsigned char *to, size_t size, const struct chunks *chunks)
{
    write_u32(to, 0x46546c67u); /* "glTF" */
    write_u32(to + 4, 2);
    write_u32(to + 8, size);
    write_u32(to + 12, aligned(chunks->json_size));
    write_u32(to + 16, GLB_CHUNK_JSON);
    copy_json(to + GLB_HEADER_BYTES, chunks);
    if (chunks->bin_size == 0)
        return;
    to += GLB_HEADER_BYTES + aligned(chunks->json_size);
    write_u32(to, aligned(chunks->bin_size));
    write_u32(to + 4, GLB_CHUNK_BIN);
    memcpy(to + GLB_CHUNK_BYTES, chunks->bin, chunks->bin_size);
    memset(to + GLB_CHUNK_BYTES + chunks->bin_size, 0,
           aligned(chunks->bin_size) - chunks->bin_size);
}

/* True if the text begins like a JSON object, behind a byte order mark and blanks. */
static bool looks_like_json(const unsigned char *text, size_t size)
{
    size_t at = size >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
    while (at < size && memchr(" \t\r\n", text[at], 4))
        at++;
    return at < size && text[at] == '{';
}

bool gltf_container_init(struct gltf_container *container, const void *bytes, size_t size,
                         const char *name, struct error *error)
{
    *container = (struct gltf_container){0};
    struct chunks chunks = {.json = bytes, .json_size = size};
    if (size > INT_MAX)
        return error_set(error, ERROR_MODEL, "%s: glTF files beyond 2 GB are not read", name);
    container->binary = size >= 4 && memcmp(bytes, "glTF", 4) == 0;
    if (container->binary && !find_chunks(&chunks, bytes, size, name, error))
        return false;
    bool is_json = looks_like_json(chunks.json, chunks.json_size);
    if (!is_json && container->binary)
        return error_set(error, ERROR_MODEL, "%s: the JSON of the GLB does not begin with '{'",
                         name);
    if (!is_json)
        return error_set(error, ERROR_MODEL,
                         "%s: not a glTF file: it begins neither with '{' (JSON) nor with 'glTF' "
                         "(GLB); an OBJ file needs a name that ends in .obj",
                         name);
    size_t json_at = container->binary ? GLB_HEADER_BYTES : 0;
    size_t all = json_at + aligned(chunks.json_size);
    if (chunks.bin_size > 0)
        all += GLB_CHUNK_BYTES + aligned(chunks.bin_size);
    container->bytes = malloc(all);
    if (!container->bytes)
        return error_set(error, ERROR_SERVER, "%s: not enough memory to read it", name);
    container->size = (unsigned)all;
    if (container->binary)
        copy_glb(container->bytes, all, &chunks);
    else
        copy_json(container->bytes, &chunks);
    container->unaligned =
        container->binary && (chunks.json_size % 4 != 0 || chunks.bin_size % 4 != 0);
    if (!gltf_json_prepare(&container->json, (char *)container->bytes + json_at, chunks.json_size,
                           name, error))
        return false;
    if (container->binary && container->json.bare_buffers > MAX_BUFFERS_BESIDE_CHUNK)
        return error_set(error, ERROR_MODEL, "%s: %u buffers in a GLB, at most %u are read", name,
                         container->json.bare_buffers, MAX_BUFFERS_BESIDE_CHUNK);
    return true;
}

void gltf_container_finish(struct gltf_container *container)
{
    free(container->bytes);
    container->bytes = NULL;
}
