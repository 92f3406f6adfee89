#include "server/surface/record_cache.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

/* A segment is a huge page; the only segment of a very small cache is a few pages. */
enum {
    SEGMENT_BYTES = 2 << 20,
    LARGE_CACHE = 8 * SEGMENT_BYTES,
    SMALL_SEGMENT_BYTES = 64 << 10,
    PAGE_BYTES = 4096
};
/* A cache line has eight entries of the hash table. */
enum { LINE_BYTES = 64, LINE_BITS = 3 };
/* An entry of the hash table: the key, and the record's number plus one; 0: no entry. */
enum { KEY_BITS = 39, NUMBER_BITS = 64 - KEY_BITS };

struct segment {
    char *records;    /* NULL: not allocated yet */
    uint32_t used_in; /* the latest use that found a record in it */
};

struct record_cache {
    size_t record_bytes, segment_bytes;
    uint32_t per_segment, n_segments, use;
    uint64_t n_taken; /* number of records taken; above `most` when full */
    uint64_t *entry;  /* [mask + 1] */
    uint64_t mask;
    struct segment *segment;
};

static size_t segment_bytes_of(size_t record_bytes, size_t most)
{
    size_t bytes = most * record_bytes;
    if (bytes >= LARGE_CACHE)
        return SEGMENT_BYTES;
    if (bytes >= SMALL_SEGMENT_BYTES)
        return SMALL_SEGMENT_BYTES;
    return bytes / PAGE_BYTES * PAGE_BYTES + PAGE_BYTES;
}

static uint64_t segments_of(size_t record_bytes, size_t most)
{
    size_t per_segment = segment_bytes_of(record_bytes, most) / record_bytes;
    uint64_t n = most / per_segment;
    return n ? n : 1;
}

/* The size of the hash table; at least a third of its entries stay free. */
static uint64_t entries_of(uint64_t records)
{
    uint64_t n = 64;
    while (2 * n < 3 * records)
        n *= 2;
    return n;
}

size_t record_cache_most_bytes(size_t record_bytes, size_t most)
{
    size_t segment_bytes = segment_bytes_of(record_bytes, most);
    uint64_t n = segments_of(record_bytes, most), records = n * (segment_bytes / record_bytes);
    return sizeof(struct record_cache) + n * (segment_bytes + sizeof(struct segment)) +
           entries_of(records) * sizeof(uint64_t);
}

struct record_cache *record_cache_create(size_t record_bytes, size_t most)
{
    struct record_cache *cache = calloc(1, sizeof *cache);
    if (!cache)
        return NULL;
    cache->record_bytes = record_bytes;
    cache->segment_bytes = segment_bytes_of(record_bytes, most);
    cache->per_segment = (uint32_t)(cache->segment_bytes / record_bytes);
    cache->n_segments = (uint32_t)segments_of(record_bytes, most);
    cache->mask = entries_of((uint64_t)cache->n_segments * cache->per_segment) - 1;
    cache->entry = aligned_alloc(LINE_BYTES, (cache->mask + 1) * sizeof *cache->entry);
    if (cache->entry)
        memset(cache->entry, 0, (cache->mask + 1) * sizeof *cache->entry);
    cache->segment = calloc(cache->n_segments, sizeof *cache->segment);
    if (cache->entry && cache->segment &&
        (uint64_t)cache->n_segments * cache->per_segment < (1u << NUMBER_BITS) - 1)
        return cache;
    record_cache_destroy(cache);
    return NULL;
}

void record_cache_destroy(struct record_cache *cache)
{
    if (!cache)
        return;
    for (uint32_t i = 0; cache->segment && i < cache->n_segments; i++)
        free(cache->segment[i].records);
    free(cache->segment);
    free(cache->entry);
    free(cache);
}

size_t record_cache_bytes(const struct record_cache *cache)
{
    size_t bytes = sizeof *cache + (cache->mask + 1) * sizeof *cache->entry +
                   cache->n_segments * sizeof *cache->segment;
    for (uint32_t i = 0; i < cache->n_segments; i++)
        bytes += cache->segment[i].records ? cache->segment_bytes : 0;
    return bytes;
}

/* The entry at which the search for a key begins. Parts of a node are mostly looked up one after the other, so that
 * eight of them begin in one cache line. */
static uint64_t place_of(const struct record_cache *cache, uint64_t key)
{
    uint64_t line = (key >> LINE_BITS) * 0x9e3779b97f4a7c15u;
    line ^= line >> 29;
    return (line << LINE_BITS | (key & ((1u << LINE_BITS) - 1))) & cache->mask;
}

/* A record's place in a segment that has been reserved. The read is atomic because reserve() may try
 * to set `records` again in another thread. */
static char *place_in(const struct record_cache *cache, const struct segment *segment,
                      uint64_t number)
{
    return __atomic_load_n(&segment->records, __ATOMIC_RELAXED) +
           (size_t)(number % cache->per_segment) * cache->record_bytes;
}

static const void *record_of(struct record_cache *cache, uint64_t entry)
{
    uint32_t number = (uint32_t)(entry & ((1u << NUMBER_BITS) - 1)) - 1;
    struct segment *segment = &cache->segment[number / cache->per_segment];
    if (__atomic_load_n(&segment->used_in, __ATOMIC_RELAXED) != cache->use)
        __atomic_store_n(&segment->used_in, cache->use, __ATOMIC_RELAXED);
    return place_in(cache, segment, number);
}

void record_cache_expect(const struct record_cache *cache, uint64_t key)
{
    __builtin_prefetch(&cache->entry[place_of(cache, key)]);
}

const void *record_cache_find(struct record_cache *cache, uint64_t key)
{
    for (uint64_t at = place_of(cache, key);; at = (at + 1) & cache->mask) {
        uint64_t entry = __atomic_load_n(&cache->entry[at], __ATOMIC_ACQUIRE);
        if (!entry)
            return NULL;
        if (entry >> NUMBER_BITS == key)
            return record_of(cache, entry);
    }
}

/* Allocates the records of a segment, unless it has some. */
static bool reserve(struct record_cache *cache, struct segment *segment)
{
    char *none = NULL;
    if (__atomic_load_n(&segment->records, __ATOMIC_ACQUIRE))
        return true;
    char *taken = aligned_alloc(cache->segment_bytes == SEGMENT_BYTES ? SEGMENT_BYTES : 64,
                                cache->segment_bytes);
    if (!taken)
        return false;
    if (cache->segment_bytes == SEGMENT_BYTES)
        madvise(taken, SEGMENT_BYTES, MADV_HUGEPAGE); /* only a hint: it works without huge pages */
    if (!__atomic_compare_exchange_n(&segment->records, &none, taken, false, __ATOMIC_ACQ_REL,
                                     __ATOMIC_ACQUIRE))
        free(taken); /* another thread was first */
    return true;
}

const void *record_cache_add(struct record_cache *cache, uint64_t key, const void *record)
{
    uint64_t most = (uint64_t)cache->n_segments * cache->per_segment;
    if (__atomic_load_n(&cache->n_taken, __ATOMIC_RELAXED) >= most)
        return NULL;
    uint64_t number = __atomic_fetch_add(&cache->n_taken, 1, __ATOMIC_RELAXED);
    if (number >= most)
        return NULL;
    struct segment *segment = &cache->segment[number / cache->per_segment];
    if (!reserve(cache, segment))
        return NULL;
    memcpy(place_in(cache, segment, number), record, cache->record_bytes);
    uint64_t own = key << NUMBER_BITS | (number + 1);
    for (uint64_t at = place_of(cache, key);; at = (at + 1) & cache->mask) {
        uint64_t entry = 0;
        if (__atomic_compare_exchange_n(&cache->entry[at], &entry, own, false, __ATOMIC_ACQ_REL,
                                        __ATOMIC_ACQUIRE))
            return record_of(cache, own);
        if (entry >> NUMBER_BITS == key)
            return record_of(cache, entry);
    }
}

/* --- */

static uint32_t age_of(const struct record_cache *cache, uint32_t i)
{
    return cache->use - cache->segment[i].used_in;
}

/* Moves the most recently used segments to the front; `from` has the old position of each. */
static void sort_by_age(struct record_cache *cache, uint32_t *from)
{
    for (uint32_t i = 0; i < cache->n_segments; i++) {
        uint32_t at = i;
        struct segment own = cache->segment[i];
        for (; at > 0 && age_of(cache, at - 1) > cache->use - own.used_in; at--) {
            cache->segment[at] = cache->segment[at - 1];
            from[at] = from[at - 1];
        }
        cache->segment[at] = own;
        from[at] = i;
    }
}

/* Keeps the entries of the first n segments, which are given by their old numbers. */
static void keep_entries(struct record_cache *cache, const uint32_t *from, uint32_t n,
                         uint64_t *kept)
{
    size_t n_kept = 0;
    for (uint64_t at = 0; at <= cache->mask; at++) {
        uint64_t entry = cache->entry[at];
        uint32_t number = (uint32_t)(entry & ((1u << NUMBER_BITS) - 1)) - 1;
        for (uint32_t i = 0; entry && i < n; i++)
            if (number / cache->per_segment == from[i])
                kept[n_kept++] = entry - number - 1 +
                                 (uint64_t)(i * cache->per_segment + number % cache->per_segment) +
                                 1;
    }
    memset(cache->entry, 0, (cache->mask + 1) * sizeof *cache->entry);
    for (size_t i = 0; i < n_kept; i++) {
        uint64_t at = place_of(cache, kept[i] >> NUMBER_BITS);
        while (cache->entry[at])
            at = (at + 1) & cache->mask;
        cache->entry[at] = kept[i];
    }
}

void record_cache_turn(struct record_cache *cache)
{
    uint64_t most = (uint64_t)cache->n_segments * cache->per_segment;
    if (cache->n_taken > most - most / 4) {
        uint32_t n = cache->n_segments / 2, *from = malloc(cache->n_segments * sizeof *from);
        uint64_t *kept = malloc(((uint64_t)n * cache->per_segment + 1) * sizeof *kept);
        if (from && kept) {
            sort_by_age(cache, from);
            keep_entries(cache, from, n, kept);
            cache->n_taken = (uint64_t)n * cache->per_segment;
        } else {
            memset(cache->entry, 0, (cache->mask + 1) * sizeof *cache->entry);
            cache->n_taken = 0;
        }
        free(from);
        free(kept);
    }
    cache->use++;
}
