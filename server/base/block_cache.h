/* A cache of memory blocks that come and go with every frame: fresh pages from the system would
 * cost more time than encoding the frame.
 *
 * Freed blocks are kept by size, up to a limit; block_cache_trim() returns to the system what was
 * not used for a while. Any thread. */
#ifndef SHEEN_BASE_BLOCK_CACHE_H
#define SHEEN_BASE_BLOCK_CACHE_H

#include <stddef.h>

struct block_cache;

/* Makes a cache that keeps at most `most_bytes`; 0: nothing. NULL when memory is short. Destroy it
 * only after all blocks have been given back. */
struct block_cache *block_cache_create(size_t most_bytes);
void block_cache_destroy(struct block_cache *block_cache); /* NULL is safe */

/* As malloc() and free(). NULL as `block_cache`: from and to the heap. A block must be given
 * back to the cache that it was taken from. */
void *block_cache_take(struct block_cache *block_cache, size_t size);
void block_cache_give(struct block_cache *block_cache, void *block); /* NULL is safe */

/* Frees blocks that were not used since the last call. */
void block_cache_trim(struct block_cache *block_cache);
/* Frees all blocks that are kept. */
void block_cache_drop(struct block_cache *block_cache);
/* The bytes that are kept now. */
size_t block_cache_bytes(struct block_cache *block_cache);

#endif
