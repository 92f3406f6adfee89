/* Memory blocks that are kept for the next frame: which are kept, how many bytes, and for how
 * long. */
#include <stdarg.h>
#include <setjmp.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "server/base/block_cache.h"

static void test_a_block_comes_back_for_its_size(void **state)
{
    (void)state;
    struct block_cache *block_cache = block_cache_create(1 << 20);
    void *block = block_cache_take(block_cache, 1000);
    memset(block, 1, 1000);
    assert_int_equal((uintptr_t)block % _Alignof(max_align_t), 0);
    block_cache_give(block_cache, block);
    assert_in_range(block_cache_bytes(block_cache), 1000, 1063);
    void *small = block_cache_take(block_cache, 500);
    assert_ptr_not_equal(small, block);
    /* both sizes are rounded up to the same block size */
    assert_ptr_equal(block_cache_take(block_cache, 1001), block);
    assert_int_equal(block_cache_bytes(block_cache), 0);
    block_cache_give(block_cache, small);
    block_cache_give(block_cache, block);
    block_cache_destroy(block_cache);
}

static void test_blocks_are_as_large_as_asked(void **state)
{
    (void)state;
    struct block_cache *block_cache = block_cache_create(1 << 20);
    for (size_t size = 0; size < 5000; size += 7) {
        void *block = block_cache_take(block_cache, size);
        memset(block, 2, size);
        block_cache_give(block_cache, block);
    }
    block_cache_destroy(block_cache);
}

static void test_no_more_is_kept_than_allowed(void **state)
{
    (void)state;
    struct block_cache *block_cache = block_cache_create(4096);
    void *blocks[4];
    for (int i = 0; i < 4; i++)
        blocks[i] = block_cache_take(block_cache, 2048);
    for (int i = 0; i < 4; i++)
        block_cache_give(block_cache, blocks[i]);
    assert_int_equal(block_cache_bytes(block_cache), 4096);
    block_cache_destroy(block_cache);
}

static void test_what_lies_unused_is_trimmed(void **state)
{
    (void)state;
    struct block_cache *block_cache = block_cache_create(1 << 20);
    void *first = block_cache_take(block_cache, 2048),
         *second = block_cache_take(block_cache, 2048);
    block_cache_give(block_cache, first);
    block_cache_give(block_cache, second);
    /* trims nothing, because both blocks have been used since the cache was created */
    block_cache_trim(block_cache);
    assert_int_equal(block_cache_bytes(block_cache), 4096);
    block_cache_give(block_cache, block_cache_take(block_cache, 2048));
    /* trims one, because no two blocks have been in use at the same time */
    block_cache_trim(block_cache);
    assert_int_equal(block_cache_bytes(block_cache), 2048);
    block_cache_trim(block_cache);
    assert_int_equal(block_cache_bytes(block_cache), 0);
    block_cache_destroy(block_cache);
}

static void test_impossible_sizes_fail(void **state)
{
    (void)state;
    struct block_cache *block_cache = block_cache_create(1 << 20);
    assert_null(block_cache_take(block_cache, SIZE_MAX));
    assert_null(block_cache_take(NULL, SIZE_MAX - 100));
    block_cache_destroy(block_cache);
}

static void test_without_spares_it_is_the_heap(void **state)
{
    (void)state;
    void *block = block_cache_take(NULL, 100);
    memset(block, 3, 100);
    block_cache_give(NULL, block);
    block_cache_give(NULL, NULL);
    block_cache_destroy(NULL);
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
