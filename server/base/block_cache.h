/* Memory that comes and goes with every frame, kept for the next one: pages that are fresh from the
 * system cost more than a frame's encoding.
 *
 * Blocks are kept by size, at most so many bytes of them; what has not been wanted for a while goes
 * back to the system with block_cache_trim(). Any thread. */
#ifndef SHEEN_BASE_BLOCK_CACHE_H
#define SHEEN_BASE_BLOCK_CACHE_H

#include <stddef.h>

struct block_cache;

/* Keeps `most_bytes` at most; 0: nothing. NULL when memory is short. All blocks must have been
 * given back before it is destroyed. */
struct block_cache *block_cache_create(size_t most_bytes);
void block_cache_destroy(struct block_cache *block_cache); /* NULL is safe */

/* As malloc() and free(), which is what they are where `block_cache` is NULL; the block must be
 * given to those that it was taken from. */
void *block_cache_take(struct block_cache *block_cache, size_t size);
void block_cache_give(struct block_cache *block_cache, void *block); /* NULL is safe */

/* Frees what has lain unused since the last time. */
void block_cache_trim(struct block_cache *block_cache);
/* How much is kept now. */
size_t block_cache_bytes(struct block_cache *block_cache);

#endif
