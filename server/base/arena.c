#include "server/base/arena.h"

#include <assert.h>
#include <stdlib.h>

bool arena_init(struct arena *arena, size_t capacity)
{
    *arena = (struct arena){malloc(capacity), 0, capacity};
    return arena->memory;
}

void arena_finish(struct arena *arena)
{
    free(arena->memory);
    *arena = (struct arena){0};
}

void *arena_take(struct arena *arena, size_t bytes)
{
    bytes = (bytes + 15) / 16 * 16;
    assert(bytes <= arena->capacity - arena->used);
    void *taken = arena->memory + arena->used;
    arena->used += bytes;
    return taken;
}
