#include "server/base/block_cache.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>

/* Sixteen sizes to a power of two: blocks are 6 % larger than asked at most, which no budget knows
 * of. */
enum { PART_BITS = 4, PARTS = 1 << PART_BITS, N_SIZES = PARTS * 64, LEAST_BYTES = 64 };

/* Stands before every block. */
struct spare {
    struct spare *next;
    size_t capacity; /* of the block */
};
_Static_assert(sizeof(struct spare) % _Alignof(max_align_t) == 0, "blocks are aligned as malloc's");

struct spare_list {
    struct spare *first;
    size_t n, least_n; /* now, and since the last trim */
};

struct spares {
    pthread_mutex_t lock;
    size_t bytes, most_bytes;
    struct spare_list lists[N_SIZES];
};

struct spares *spares_create(size_t most_bytes)
{
    struct spares *spares = calloc(1, sizeof *spares);
    if (!spares)
        return NULL;
    pthread_mutex_init(&spares->lock, NULL);
    spares->most_bytes = most_bytes;
    return spares;
}

/* A size is a number of parts of a power of two. */
static size_t round_up(size_t size)
{
    if (size < LEAST_BYTES)
        size = LEAST_BYTES;
    unsigned power = 63u - (unsigned)__builtin_clzll(size);
    size_t part = (size_t)1 << (power - PART_BITS);
    return (size + part - 1) & ~(part - 1);
}

static struct spare_list *list_of(struct spares *spares, size_t capacity)
{
    unsigned power = 63u - (unsigned)__builtin_clzll(capacity);
    return &spares->lists[PARTS * power + (capacity >> (power - PART_BITS) & (PARTS - 1))];
}

static struct spare *pop(struct spares *spares, struct spare_list *list)
{
    struct spare *spare = list->first;
    if (!spare)
        return NULL;
    list->first = spare->next;
    list->n--;
    if (list->n < list->least_n)
        list->least_n = list->n;
    spares->bytes -= spare->capacity;
    return spare;
}

void *spares_take(struct spares *spares, size_t size)
{
    if (size > SIZE_MAX / 2)
        return NULL;
    size_t capacity = round_up(size);
    struct spare *spare = NULL;
    if (spares) {
        pthread_mutex_lock(&spares->lock);
        spare = pop(spares, list_of(spares, capacity));
        pthread_mutex_unlock(&spares->lock);
    }
    if (!spare && (spare = malloc(sizeof *spare + capacity)))
        spare->capacity = capacity;
    return spare ? spare + 1 : NULL;
}

/* False where that would be too much. */
static bool keep(struct spares *spares, struct spare *spare)
{
    pthread_mutex_lock(&spares->lock);
    bool fits = spare->capacity <= spares->most_bytes - spares->bytes;
    if (fits) {
        struct spare_list *list = list_of(spares, spare->capacity);
        spare->next = list->first;
        list->first = spare;
        list->n++;
        spares->bytes += spare->capacity;
    }
    pthread_mutex_unlock(&spares->lock);
    return fits;
}

void spares_give(struct spares *spares, void *block)
{
    struct spare *spare = block ? (struct spare *)block - 1 : NULL;
    if (!spares || !spare || !keep(spares, spare))
        free(spare);
}

void spares_trim(struct spares *spares)
{
    struct spare *unused = NULL;
    pthread_mutex_lock(&spares->lock);
    for (size_t i = 0; i < N_SIZES; i++) {
        struct spare_list *list = &spares->lists[i];
        for (size_t n = list->least_n; n > 0; n--) {
            struct spare *spare = pop(spares, list);
            spare->next = unused;
            unused = spare;
        }
        list->least_n = list->n;
    }
    pthread_mutex_unlock(&spares->lock);
    while (unused) {
        struct spare *next = unused->next;
        free(unused);
        unused = next;
    }
}

size_t spares_bytes(struct spares *spares)
{
    pthread_mutex_lock(&spares->lock);
    size_t bytes = spares->bytes;
    pthread_mutex_unlock(&spares->lock);
    return bytes;
}

void spares_destroy(struct spares *spares)
{
    if (!spares)
        return;
    spares_trim(spares); /* twice: what was in use since the last time is unused now */
    spares_trim(spares);
    pthread_mutex_destroy(&spares->lock);
    free(spares);
}
