/* Helpers for tests of the cage readers. */
#ifndef SHEEN_TESTS_CAGE_EXPECT_H
#define SHEEN_TESTS_CAGE_EXPECT_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <string.h>

#include "server/cage/read/read.h"

/* Reads a file that must be accepted; the caller frees the cage by cage_finish(). */
static inline void read_bytes(struct cage *cage, const void *bytes, size_t size, const char *name)
{
    struct error error = {0};
    if (!cage_read(cage, bytes, size, name, &error))
        fail_msg("refused: %s", error.text);
}

/* As read_bytes(), for an OBJ text named part.obj. */
static inline void read_obj(struct cage *cage, const char *text)
{
    read_bytes(cage, text, strlen(text), "part.obj");
}

static inline void expect_face(const struct cage *cage, size_t face, size_t n,
                               const uint32_t *vertex)
{
    assert_true(face < cage->n_faces);
    assert_int_equal(cage->face_start[face + 1] - cage->face_start[face], n);
    assert_memory_equal(&cage->face_vertex[cage->face_start[face]], vertex, n * sizeof *vertex);
}

/* Expects that the face has these corners, in this order. */
#define EXPECT_FACE(cage, face, ...)                                                               \
    expect_face(cage, face, sizeof((uint32_t[]){__VA_ARGS__}) / sizeof(uint32_t),                  \
                (uint32_t[]){__VA_ARGS__})

#endif
