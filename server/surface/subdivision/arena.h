/* A bump allocator, reset between faces: what is built for one face lives only while it is built.
 */
#ifndef SHEEN_SURFACE_SUBDIVISION_ARENA_H
#define SHEEN_SURFACE_SUBDIVISION_ARENA_H

#include <stdbool.h>
#include <stddef.h>

struct arena {
    char *memory;
    size_t used, capacity; /* bytes */
};

bool arena_init(struct arena *arena, size_t capacity);
void arena_finish(struct arena *arena);

/* Never fails: plans size the arena beforehand. The memory is not cleared. */
void *arena_take(struct arena *arena, size_t bytes);

#endif
