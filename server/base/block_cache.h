/* Memory that comes and goes with every frame, kept for the next one: pages that are fresh from the
 * system cost more than a frame's encoding.
 *
 * Blocks are kept by size, at most so many bytes of them; what has not been wanted for a while goes
 * back to the system with spares_trim(). Any thread. */
#ifndef SHEEN_BASE_BLOCK_CACHE_H
#define SHEEN_BASE_BLOCK_CACHE_H

#include <stddef.h>

struct spares;

/* Keeps `most_bytes` at most; 0: nothing. NULL when memory is short. All blocks must have been
 * given back before it is destroyed. */
struct spares *spares_create(size_t most_bytes);
void spares_destroy(struct spares *spares); /* NULL is safe */

/* As malloc() and free(), which is what they are where `spares` is NULL; the block must be given
 * to those that it was taken from. */
void *spares_take(struct spares *spares, size_t size);
void spares_give(struct spares *spares, void *block); /* NULL is safe */

/* Frees what has lain unused since the last time. */
void spares_trim(struct spares *spares);
/* How much is kept now. */
size_t spares_bytes(struct spares *spares);

#endif
