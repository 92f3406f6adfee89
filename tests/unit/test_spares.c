/* Memory kept for the next frame: what is kept, how much, and for how long. */
#include <stdarg.h>
#include <setjmp.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "server/base/block_cache.h"

static void test_a_block_comes_back_for_its_size(void **state)
{
    (void)state;
    struct spares *spares = spares_create(1 << 20);
    void *block = spares_take(spares, 1000);
    memset(block, 1, 1000);
    assert_int_equal((uintptr_t)block % _Alignof(max_align_t), 0);
    spares_give(spares, block);
    assert_in_range(spares_bytes(spares), 1000, 1063);
    void *small = spares_take(spares, 500);
    assert_ptr_not_equal(small, block);
    assert_ptr_equal(spares_take(spares, 1001), block); /* rounded up alike */
    assert_int_equal(spares_bytes(spares), 0);
    spares_give(spares, small);
    spares_give(spares, block);
    spares_destroy(spares);
}

static void test_blocks_are_as_large_as_asked(void **state)
{
    (void)state;
    struct spares *spares = spares_create(1 << 20);
    for (size_t size = 0; size < 5000; size += 7) {
        void *block = spares_take(spares, size);
        memset(block, 2, size);
        spares_give(spares, block);
    }
    spares_destroy(spares);
}

static void test_no_more_is_kept_than_allowed(void **state)
{
    (void)state;
    struct spares *spares = spares_create(4096);
    void *blocks[4];
    for (int i = 0; i < 4; i++)
        blocks[i] = spares_take(spares, 2048);
    for (int i = 0; i < 4; i++)
        spares_give(spares, blocks[i]);
    assert_int_equal(spares_bytes(spares), 4096);
    spares_destroy(spares);
}

static void test_what_lies_unused_is_trimmed(void **state)
{
    (void)state;
    struct spares *spares = spares_create(1 << 20);
    void *first = spares_take(spares, 2048), *second = spares_take(spares, 2048);
    spares_give(spares, first);
    spares_give(spares, second);
    spares_trim(spares); /* both have been used since it began */
    assert_int_equal(spares_bytes(spares), 4096);
    spares_give(spares, spares_take(spares, 2048));
    spares_trim(spares); /* one at a time has been enough */
    assert_int_equal(spares_bytes(spares), 2048);
    spares_trim(spares);
    assert_int_equal(spares_bytes(spares), 0);
    spares_destroy(spares);
}

static void test_impossible_sizes_fail(void **state)
{
    (void)state;
    struct spares *spares = spares_create(1 << 20);
    assert_null(spares_take(spares, SIZE_MAX));
    assert_null(spares_take(NULL, SIZE_MAX - 100));
    spares_destroy(spares);
}

static void test_without_spares_it_is_the_heap(void **state)
{
    (void)state;
    void *block = spares_take(NULL, 100);
    memset(block, 3, 100);
    spares_give(NULL, block);
    spares_give(NULL, NULL);
    spares_destroy(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_block_comes_back_for_its_size),
        cmocka_unit_test(test_blocks_are_as_large_as_asked),
        cmocka_unit_test(test_no_more_is_kept_than_allowed),
        cmocka_unit_test(test_what_lies_unused_is_trimmed),
        cmocka_unit_test(test_impossible_sizes_fail),
        cmocka_unit_test(test_without_spares_it_is_the_heap),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
