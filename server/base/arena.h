/* An arena: one block of memory from which small pieces are taken for a short time, for example
 * while one face is built. All pieces are given back at once, or down to a mark (`used`).
 * Thread: one at a time. */
#ifndef SHEEN_BASE_ARENA_H
#define SHEEN_BASE_ARENA_H

#include <stdbool.h>
#include <stddef.h>

struct arena {
    char *memory;
    size_t used, capacity; /* bytes */
};

/* Allocates `capacity` bytes. False when memory is short. */
bool arena_init(struct arena *arena, size_t capacity);
void arena_finish(struct arena *arena);

/* Returns `bytes` bytes, aligned to 16 bytes and not cleared. The caller has sized the arena in
 * advance: there is no check. */
void *arena_take(struct arena *arena, size_t bytes);

#endif
