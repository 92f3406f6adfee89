/* Records of one size that are made when they are first wanted, found by 39-bit keys. It holds no
 * more than a number of records; what has not been used for longest goes first, a segment of
 * records at a time, but only between two uses (record_cache_turn()): while a use lasts, records
 * stay where they are. Once a use has filled the cache, its other records are not kept.
 *
 * Threads: any number may find and add at once; create, turn, bytes and destroy are for one alone. */
#ifndef SHEEN_SURFACE_RECORD_CACHE_H
#define SHEEN_SURFACE_RECORD_CACHE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct record_cache;

/* For at most `most` records (at least 1 segment of them) of a multiple of 8 bytes each. Takes
 * memory as it fills. NULL when memory is short. */
struct record_cache *record_cache_create(size_t record_bytes, size_t most);
void record_cache_destroy(struct record_cache *cache); /* NULL is safe */

/* The key of part `index` (below 128) of node `node`. */
static inline uint64_t record_cache_key(uint32_t node, uint32_t index)
{
    return (uint64_t)node << 7 | index;
}

/* NULL where there is none. */
const void *record_cache_find(struct record_cache *cache, uint64_t key);
/* Copies a record into the cache and returns the copy, or the one that another thread has added
 * meanwhile. NULL where there is no room. */
const void *record_cache_add(struct record_cache *cache, uint64_t key, const void *record);

/* A use ends and the next one begins. Where less than a quarter of the room is left, makes half of
 * it free. */
void record_cache_turn(struct record_cache *cache);

/* What it takes in main memory now, and at most. */
size_t record_cache_bytes(const struct record_cache *cache);
size_t record_cache_most_bytes(size_t record_bytes, size_t most);

#endif
