/* Tiles cover each pixel of the picture once, keep to the requested size, and their margins end at
 * the picture's border. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "server/render/tiles.h"

enum { LONGEST_PX = 4096, SMALLEST_PX = 128 };

static uint32_t random_up_to(uint32_t most)
{
    return 1 + (uint32_t)rand() % most;
}

static bool contains(const struct tile *outer, const struct tile *inner)
{
    return outer->x <= inner->x && outer->y <= inner->y &&
           outer->x + outer->width >= inner->x + inner->width &&
           outer->y + outer->height >= inner->y + inner->height;
}

static void check_margin(const struct tile *tile, const struct tile_size *size, uint32_t width,
                         uint32_t height)
{
    const struct tile whole = {0, 0, width, height};
    struct tile drawn = tile_with_margin(tile, true, width, height);
    struct tile behind = tile_with_margin(tile, false, width, height);
    struct tile_size most = tile_size_with_margin(size, width, height);
    assert_true(contains(&whole, &drawn) && contains(&drawn, tile) && contains(&drawn, &behind));
    assert_true(drawn.width <= most.width && drawn.height <= most.height);
    assert_true(drawn.x == 0 || tile->x - drawn.x == TILE_MARGIN_PX);
    assert_true(drawn.y == 0 || tile->y - drawn.y == TILE_MARGIN_PX);
    assert_true(drawn.x + drawn.width == width ||
                drawn.x + drawn.width == tile->x + tile->width + TILE_MARGIN_PX);
    assert_true(drawn.y + drawn.height == height ||
                drawn.y + drawn.height == tile->y + tile->height + TILE_MARGIN_PX);
    assert_true(behind.x == tile->x && behind.y == tile->y);
    assert_int_equal(behind.x + behind.width, drawn.x + drawn.width);
    assert_int_equal(behind.y + behind.height, drawn.y + drawn.height);
    struct tile within = tile_within(tile, &drawn);
    assert_true(within.x == tile->x - drawn.x && within.y == tile->y - drawn.y);
    assert_int_equal(tile_is_same(&drawn, tile),
                     drawn.width == tile->width && drawn.height == tile->height);
}

/* Pictures of many shapes, and tiles of many sizes. */
static void test_cover_once(void **state)
{
    (void)state;
    unsigned n_whole = 0, n_cut = 0;
    srand(11);
    for (int i = 0; i < 2000; i++) {
        uint32_t width = random_up_to(i % 3 ? 3000 : 20000),
                 height = random_up_to(i % 5 ? 2000 : 16384);
        uint64_t tile_px = i % 7 ? (uint64_t)random_up_to(1 << 20) : 0, covered = 0;
        bool whole_blocks = i % 2;
        const struct tile_size size = tiles_cut(width, height, tile_px, whole_blocks);
        bool one = size.width == width && size.height == height;
        uint64_t area = (uint64_t)size.width * size.height;
        assert_true(size.width <= LONGEST_PX && size.height <= LONGEST_PX);
        assert_true(!tile_px || area <= tile_px || area <= SMALLEST_PX * SMALLEST_PX);
        if ((uint64_t)width * height <= tile_px && width <= LONGEST_PX && height <= LONGEST_PX)
            assert_true(one);
        assert_true(one || size.width >= SMALLEST_PX || size.width == width);
        assert_true(size.width == width || size.width % COVER_BLOCK_PX == 0);
        assert_true(!whole_blocks || size.height == height || size.height % COVER_BLOCK_PX == 0);
        for (uint32_t y = 0; y < height; y += size.height)
            for (uint32_t x = 0; x < width; x += size.width) {
                const struct tile tile = tile_at(x, y, &size, width, height);
                assert_true(tile.x == x && tile.y == y && tile.width > 0 && tile.height > 0);
                covered += (uint64_t)tile.width * tile.height;
                check_margin(&tile, &size, width, height);
            }
        assert_true(covered == (uint64_t)width * height);
        n_whole += one;
        n_cut += !one;
    }
    assert_true(n_whole > 100 && n_cut > 1000);
}

/* The sizes of tiles that the daemon uses. */
static void test_known(void **state)
{
    (void)state;
    static const struct {
        uint32_t width, height;
        uint64_t tile_px;
        struct tile_size size;
    } cases[] = {
        {1280, 720, 0, {1280, 720}},         {5000, 1200, 0, {4096, 1200}},
        {1600, 1000, 256 * 256, {256, 256}}, {1600, 1000, 512 * 512, {512, 512}},
        {100, 3000, 256 * 256, {100, 655}},  {3000, 100, 256 * 256, {256, 100}},
        {640, 480, 1, {128, 128}},           {64, 48, 1, {64, 48}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct tile_size size = tiles_cut(cases[i].width, cases[i].height, cases[i].tile_px, false);
        assert_int_equal(size.width, cases[i].size.width);
        assert_int_equal(size.height, cases[i].size.height);
    }
    assert_int_equal(tiles_cut(100, 3000, 256 * 256, true).height, 648);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cover_once),
        cmocka_unit_test(test_known),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
