#include "server/base/block_cache.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/queue.h>

/* Sixteen sizes for each power of two, so that a block is at most 6 % larger than asked for. The
 * memory budget does not count these 6 %. */
enum { PART_BITS = 4, PARTS = 1 << PART_BITS, N_SIZES = PARTS * 64, LEAST_BYTES = 64 };

/* Precedes every block. */
struct spare {
    SLIST_ENTRY(spare) link;
    size_t capacity; /* of the block */
};
_Static_assert(sizeof(struct spare) % _Alignof(max_align_t) == 0, "blocks are aligned as malloc's");

struct spare_list {
    SLIST_HEAD(spares, spare) spares; /* latest first; zeroed: empty */
    /* Number of blocks now, and the smallest number since the last trim. */
    size_t n, least_n;
};

struct block_cache {
    pthread_mutex_t lock;
    size_t bytes, most_bytes;
    struct spare_list lists[N_SIZES];
};

struct block_cache *block_cache_create(size_t most_bytes)
{
    struct block_cache *block_cache = calloc(1, sizeof *block_cache);
    if (!block_cache)
        return NULL;
    pthread_mutex_init(&block_cache->lock, NULL);
    block_cache->most_bytes = most_bytes;
    return block_cache;
}

/* Rounds a size up to a multiple of 1/16 of the power of two below it. */
static size_t round_up(size_t size)
{
    if (size < LEAST_BYTES)
        size = LEAST_BYTES;
    unsigned power = 63u - (unsigned)__builtin_clzll(size);
    size_t part = (size_t)1 << (power - PART_BITS);
    return (size + part - 1) & ~(part - 1);
}

static struct spare_list *list_of(struct block_cache *block_cache, size_t capacity)
{
    unsigned power = 63u - (unsigned)__builtin_clzll(capacity);
    return &block_cache->lists[PARTS * power + (capacity >> (power - PART_BITS) & (PARTS - 1))];
}

static struct spare *pop(struct block_cache *block_cache, struct spare_list *list)
{
    struct spare *spare = SLIST_FIRST(&list->spares);
    if (!spare)
        return NULL;
    SLIST_REMOVE_HEAD(&list->spares, link);
    list->n--;
    if (list->n < list->least_n)
        list->least_n = list->n;
    block_cache->bytes -= spare->capacity;
    return spare;
}

void *block_cache_take(struct block_cache *block_cache, size_t size)
{
    if (size > SIZE_MAX / 2)
        return NULL;
    size_t capacity = round_up(size);
    struct spare *spare = NULL;
    if (block_cache) {
        pthread_mutex_lock(&block_cache->lock);
        spare = pop(block_cache, list_of(block_cache, capacity));
        pthread_mutex_unlock(&block_cache->lock);
    }
    if (!spare && (spare = malloc(sizeof *spare + capacity)))
        spare->capacity = capacity;
    return spare ? spare + 1 : NULL;
}

/* Keeps a block; false if that would exceed the limit. */
static bool keep(struct block_cache *block_cache, struct spare *spare)
{
    pthread_mutex_lock(&block_cache->lock);
    bool fits = spare->capacity <= block_cache->most_bytes - block_cache->bytes;
    if (fits) {
        struct spare_list *list = list_of(block_cache, spare->capacity);
        SLIST_INSERT_HEAD(&list->spares, spare, link);
        list->n++;
        block_cache->bytes += spare->capacity;
    }
    pthread_mutex_unlock(&block_cache->lock);
    return fits;
}

void block_cache_give(struct block_cache *block_cache, void *block)
{
    struct spare *spare = block ? (struct spare *)block - 1 : NULL;
    if (!block_cache || !spare || !keep(block_cache, spare))
        free(spare);
}

void block_cache_trim(struct block_cache *block_cache)
{
    struct spares unused = SLIST_HEAD_INITIALIZER(unused);
    pthread_mutex_lock(&block_cache->lock);
    for (size_t i = 0; i < N_SIZES; i++) {
        struct spare_list *list = &block_cache->lists[i];
        for (size_t n = list->least_n; n > 0; n--) {
            struct spare *spare = pop(block_cache, list);
            SLIST_INSERT_HEAD(&unused, spare, link);
        }
        list->least_n = list->n;
    }
    pthread_mutex_unlock(&block_cache->lock);
    while (!SLIST_EMPTY(&unused)) {
        struct spare *spare = SLIST_FIRST(&unused);
        SLIST_REMOVE_HEAD(&unused, link);
        free(spare);
    }
}

void block_cache_drop(struct block_cache *block_cache)
{
    /* What was used since the last trim is unused at the second. */
    block_cache_trim(block_cache);
    block_cache_trim(block_cache);
}

size_t block_cache_bytes(struct block_cache *block_cache)
{
    pthread_mutex_lock(&block_cache->lock);
    size_t bytes = block_cache->bytes;
    pthread_mutex_unlock(&block_cache->lock);
    return bytes;
}

void block_cache_destroy(struct block_cache *block_cache)
{
    if (!block_cache)
        return;
    block_cache_drop(block_cache);
    pthread_mutex_destroy(&block_cache->lock);
    free(block_cache);
}
