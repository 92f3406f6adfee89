/* Memory for what lives for a short time, as while one face is built: taken piece by piece, given back all at once or
 * down to a mark (`used`). One thread. */
#ifndef SHEEN_BASE_ARENA_H
#define SHEEN_BASE_ARENA_H

#include <stdbool.h>
#include <stddef.h>

struct arena {
    char *memory;
    size_t used, capacity; /* bytes */
};

/* False: memory is short. */
bool arena_init(struct arena *arena, size_t capacity);
void arena_finish(struct arena *arena);

/* Memory on a multiple of 16 bytes, not cleared. Never fails: plans size the arena beforehand. */
void *arena_take(struct arena *arena, size_t bytes);

#endif
