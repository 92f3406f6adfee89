/* Small glTF files for the tests of the glTF reader, and what is expected of them. */
#ifndef SHEEN_TESTS_GLTF_SAMPLE_H
#define SHEEN_TESTS_GLTF_SAMPLE_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/unit/cage_expect.h"

/* The parts of a small file; NULL takes the usual, which is one quad pair:
 *   3 - 4 - 5
 *   |   |   |
 *   0 - 1 - 2     */
struct sample {
    const char *top;        /* members of the root, each ending in a comma */
    const char *scene;      /* "scene" and "scenes" */
    const char *nodes;      /* the array's content */
    const char *meshes;     /* the array's content; if set, the next two members are ignored */
    const char *primitive;  /* members of the primitive after "attributes" and "indices" */
    const char *mesh;       /* members of the mesh after "primitives" */
    const char *accessors;  /* the array's content */
    const char *views;      /* the array's content */
    const char *buffers;    /* the array's content */
    const float *positions; /* n_positions * 3 */
    size_t n_positions;
    const uint16_t *indices;
    size_t n_indices;
};

static const float GRID[] = {0, 0, 0, 1, 0, 0, 2, 0, 0, 0, 1, 0, 1, 1, 0, 2, 1, 0};
static const uint16_t PAIR[] = {0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4};
static const char NGON[] = "\"extensions\":{\"FB_ngon_encoding\":{}}";

struct bytes {
    unsigned char *data;
    size_t size;
};

static inline void put_u32(unsigned char *at, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        at[i] = (unsigned char)(value >> (8 * i));
}

static inline struct bytes make_glb(const char *json, const void *chunk, size_t chunk_size)
{
    size_t json_size = (strlen(json) + 3) / 4 * 4, padded = (chunk_size + 3) / 4 * 4;
    size_t size = 20 + json_size + (chunk ? 8 + padded : 0);
    unsigned char *data = calloc(1, size);
    assert_non_null(data);
    memcpy(data, "glTF", 4);
    put_u32(data + 4, 2);
    put_u32(data + 8, (uint32_t)size);
    put_u32(data + 12, (uint32_t)json_size);
    memcpy(data + 16, "JSON", 4);
    memset(data + 20, ' ', json_size);
    memcpy(data + 20, json, strlen(json));
    if (chunk) {
        put_u32(data + 20 + json_size, (uint32_t)padded);
        memcpy(data + 24 + json_size, "BIN", 4);
        memcpy(data + 28 + json_size, chunk, chunk_size);
    }
    return (struct bytes){data, size};
}

static const char *or_else(const char *text, const char *standard)
{
    return text ? text : standard;
}

static inline struct bytes make_file(const struct sample *sample)
{
    const float *positions = sample->positions ? sample->positions : GRID;
    const uint16_t *indices = sample->indices ? sample->indices : PAIR;
    size_t n_positions = sample->positions ? sample->n_positions : 6;
    size_t n_indices = sample->indices ? sample->n_indices : 12;
    size_t position_bytes = n_positions * 12, index_bytes = n_indices * 2;
    char meshes[1000], accessors[500], views[500], buffers[100], json[4000];
    snprintf(meshes, sizeof meshes,
             "{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1,%s}]%s}",
             or_else(sample->primitive, NGON), or_else(sample->mesh, ""));
    snprintf(accessors, sizeof accessors,
             "{\"bufferView\":0,\"componentType\":5126,\"type\":\"VEC3\",\"count\":%zu},"
             "{\"bufferView\":1,\"componentType\":5123,\"type\":\"SCALAR\",\"count\":%zu}",
             n_positions, n_indices);
    snprintf(views, sizeof views,
             "{\"buffer\":0,\"byteLength\":%zu},"
             "{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu}",
             position_bytes, position_bytes, index_bytes);
    snprintf(buffers, sizeof buffers, "{\"byteLength\":%zu}", position_bytes + index_bytes);
    int length = snprintf(json, sizeof json,
                          "{\"asset\":{\"version\":\"2.0\"},%s%s,\"nodes\":[%s],\"meshes\":[%s],"
                          "\"accessors\":[%s],\"bufferViews\":[%s],\"buffers\":[%s]}",
                          or_else(sample->top, ""),
                          or_else(sample->scene, "\"scene\":0,\"scenes\":[{\"nodes\":[0]}]"),
                          or_else(sample->nodes, "{\"mesh\":0}"), or_else(sample->meshes, meshes),
                          or_else(sample->accessors, accessors), or_else(sample->views, views),
                          or_else(sample->buffers, buffers));
    assert_true(length > 0 && (size_t)length < sizeof json);
    unsigned char *chunk = malloc(position_bytes + index_bytes);
    assert_non_null(chunk);
    memcpy(chunk, positions, position_bytes);
    memcpy(chunk + position_bytes, indices, index_bytes);
    struct bytes file = make_glb(json, chunk, position_bytes + index_bytes);
    free(chunk);
    return file;
}

static inline void read_good(struct cage *cage, const struct sample *sample)
{
    struct bytes file = make_file(sample);
    read_bytes(cage, file.data, file.size, "part.glb");
    free(file.data);
}

static inline void expect_bytes_bad(const void *data, size_t size, const char *message)
{
    struct cage cage;
    struct error error = {0};
    if (cage_read(&cage, data, size, "part.glb", &error))
        fail_msg("not refused; should be: %s", message);
    assert_int_equal(error.kind, ERROR_MODEL);
    if (strncmp(error.text, message, strlen(message)) != 0)
        fail_msg("\n     says: %s\nshould be: %s", error.text, message);
    assert_null(cage.position);
}

static inline void expect_bad(const struct sample *sample, const char *message)
{
    struct bytes file = make_file(sample);
    expect_bytes_bad(file.data, file.size, message);
    free(file.data);
}

static inline void expect_text_bad(const char *json, const char *message)
{
    expect_bytes_bad(json, strlen(json), message);
}

static inline void expect_position(const struct cage *cage, size_t vertex, double x, double y,
                                   double z)
{
    assert_true(vertex < cage->n_vertices);
    const double *p = cage->position[vertex];
    if (p[0] != x || p[1] != y || p[2] != z)
        fail_msg("vertex %zu is %.17g %.17g %.17g, not %.17g %.17g %.17g", vertex, p[0], p[1], p[2],
                 x, y, z);
}

#endif
