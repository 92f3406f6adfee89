#include "server/assets/store_shares.h"

#include <stdlib.h>
#include <string.h>

struct holder *holder_find(struct holders *holders, const uint8_t id[static HOLDER_ID_BYTES])
{
    struct holder *holder = holders->first;
    while (holder && memcmp(holder->id, id, HOLDER_ID_BYTES) != 0)
        holder = holder->next;
    if (holder)
        holder->references++;
    return holder;
}

struct holder *holder_get(struct holders *holders, const uint8_t id[static HOLDER_ID_BYTES])
{
    struct holder *holder = holder_find(holders, id);
    if (holder || !(holder = calloc(1, sizeof *holder)))
        return holder;
    memcpy(holder->id, id, sizeof holder->id);
    holder->references = 1;
    holder->next = holders->first;
    holders->first = holder;
    holders->n++;
    return holder;
}

void holder_put(struct holders *holders, struct holder *holder)
{
    if (!holder || --holder->references > 0)
        return;
    struct holder **link = &holders->first;
    while (*link != holder)
        link = &(*link)->next;
    *link = holder->next;
    holders->n--;
    free(holder);
}

void holders_begin(struct holders *holders)
{
    holders->round++;
}

struct holder *holders_next(struct holders *holders, enum holding what, size_t share)
{
    struct holder *most = NULL;
    for (struct holder *holder = holders->first; holder; holder = holder->next)
        if (holder->round != holders->round && holder->held[what] > share &&
            (!most || holder->held[what] > most->held[what]))
            most = holder;
    if (most)
        most->round = holders->round;
    return most;
}
