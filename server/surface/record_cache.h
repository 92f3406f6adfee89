/* A cache of records of one size, which are made when they are first needed and found by keys of 39
 * bits. It has a limited number of records. They lie in segments: blocks of 2 MiB, or of 64 KiB and
 * less in caches below 16 MiB. The least recently used segments lose all their records, but only
 * between two uses (record_cache_turn()): during a use records do not move. If one use fills the
 * cache, its further records are not kept.
 *
 * Thread: any number may find and add at the same time; create, turn, bytes and destroy need all
 * others to have stopped. */
#ifndef SHEEN_SURFACE_RECORD_CACHE_H
#define SHEEN_SURFACE_RECORD_CACHE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct record_cache;

/* Makes a cache for at most `most` records (at least 1 segment) of record_bytes, a multiple of 8.
 * Allocates as it fills. NULL when memory is short. */
struct record_cache *record_cache_create(size_t record_bytes, size_t most);
void record_cache_destroy(struct record_cache *cache); /* NULL is safe */

/* The key of part `index` (below 128) of node `node`. */
static inline uint64_t record_cache_key(uint32_t node, uint32_t index)
{
    return (uint64_t)node << 7 | index;
}

/* Tells the processor that this key will be looked up soon. */
void record_cache_expect(const struct record_cache *cache, uint64_t key);
/* Finds a record; NULL if it is not in the cache. */
const void *record_cache_find(struct record_cache *cache, uint64_t key);
/* Copies a record into the cache and returns the copy, or the record that another thread has added
 * in the meantime. NULL if there is no room. */
const void *record_cache_add(struct record_cache *cache, uint64_t key, const void *record);

/* Ends a use and begins the next. If less than a quarter of the room is left, the cache forgets the
 * records of half of its segments, rounded up, those that were not used for longest; a cache of one
 * segment forgets all its records. The memory of these segments stays allocated, for new records. */
void record_cache_turn(struct record_cache *cache);

/* Main memory in bytes: of a cache now, and of a full cache. */
size_t record_cache_bytes(const struct record_cache *cache);
size_t record_cache_most_bytes(size_t record_bytes, size_t most);

#endif
