/* Helpers for tests of the cage readers. */
#ifndef SHEEN_TESTS_CAGE_EXPECT_H
#define SHEEN_TESTS_CAGE_EXPECT_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdlib.h>
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

/* Reads a file of this name that must be refused because of its contents; returns the error. */
static inline struct error refusal_of(const char *bytes, size_t size, const char *name)
{
    struct cage cage;
    struct error error = {0};
    /* A copy without a terminating zero, so that a sanitizer finds a read beyond its end. */
    char *copy = malloc(size ? size : 1);
    assert_non_null(copy);
    memcpy(copy, bytes, size);
    bool ok = cage_read(&cage, copy, size, name, &error);
    free(copy);
    if (ok)
        fail_msg("not refused: %.*s", (int)size, bytes);
    assert_int_equal(error.kind, ERROR_MODEL);
    assert_null(cage.position);
    return error;
}

static inline void expect_cage_refused(const char *bytes, size_t size, const char *name,
                                       const char *message)
{
    struct error error = refusal_of(bytes, size, name);
    assert_string_equal(error.text, message);
}

/* Expects one line that contains these words. */
static inline void expect_cage_refused_with(const char *bytes, size_t size, const char *name,
                                            const char *words)
{
    struct error error = refusal_of(bytes, size, name);
    if (!strstr(error.text, words) || strchr(error.text, '\n'))
        fail_msg("'%.*s' says '%s', not '%s'", (int)size, bytes, error.text, words);
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
