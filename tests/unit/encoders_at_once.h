/* Tests two encoders at the same time, each in its own thread: neither an encoder's earlier work
 * nor the other encoder changes a byte of a file. */
#ifndef SHEEN_TESTS_UNIT_ENCODERS_AT_ONCE_H
#define SHEEN_TESTS_UNIT_ENCODERS_AT_ONCE_H

#include <pthread.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

enum { AT_ONCE_WIDTH = 640, AT_ONCE_HEIGHT = 480 };

/* Makes n files of a picture of this size with one encoder, and returns the last, which the caller
 * frees. */
typedef uint8_t *encode_again(const uint8_t *rgba, int n, size_t *size);

struct encoding {
    encode_again *encode;
    uint8_t *rgba;
    uint8_t *file;
    size_t size;
};

static void *encode_five_times(void *argument)
{
    struct encoding *encoding = argument;
    encoding->file = encoding->encode(encoding->rgba, 5, &encoding->size);
    return NULL;
}

/* Takes the ownership of the pictures, which are from malloc(). */
static void expect_same_at_once(encode_again *encode, uint8_t *const rgba[2])
{
    pthread_t threads[2];
    struct encoding encodings[2];
    for (int i = 0; i < 2; i++) {
        encodings[i] = (struct encoding){.encode = encode, .rgba = rgba[i]};
        assert_int_equal(pthread_create(&threads[i], NULL, encode_five_times, &encodings[i]), 0);
    }
    for (int i = 0; i < 2; i++)
        assert_int_equal(pthread_join(threads[i], NULL), 0);
    for (int i = 0; i < 2; i++) {
        size_t size;
        uint8_t *file = encode(rgba[i], 1, &size);
        assert_int_equal(size, encodings[i].size);
        assert_memory_equal(file, encodings[i].file, size);
        free(file);
        free(encodings[i].file);
        free(rgba[i]);
    }
}

#endif
