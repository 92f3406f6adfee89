#include "server/base/turns.h"

#include <stddef.h>

void turns_join(struct turns *turns, struct turn *turn)
{
    if (!turns->first) {
        turn->next = turn->previous = turns->first = turn;
        return;
    }
    turn->next = turns->first; /* the last of the round */
    turn->previous = turns->first->previous;
    turn->previous->next = turn;
    turn->next->previous = turn;
}

void turns_leave(struct turns *turns, struct turn *turn)
{
    turn->previous->next = turn->next;
    turn->next->previous = turn->previous;
    if (turns->first == turn)
        turns->first = turn->next == turn ? NULL : turn->next;
    turn->next = turn->previous = NULL;
}

/* A member's deficit in the ring's current round. A member saves up no more than the ring allows; one
 * that used more than its part pays it back even while it wants nothing. */
static int64_t deficit_us(const struct turns *turns, const struct turn *turn)
{
    uint64_t rounds = turns->round - turn->round;
    const int64_t most = TURNS_QUANTUM_US + turns->saved_us;
    if (rounds > UINT32_MAX)
        return most;
    int64_t us = turn->deficit_us + (int64_t)rounds * TURNS_QUANTUM_US;
    return us < most ? us : most;
}

/* The next member, from the one whose turn it is once round the ring: the first that has time left, or
 * will have it first. *rounds_short is the number of rounds until then. */
static struct turn *find(const struct turns *turns,
                         bool (*can_use)(const struct turn *turn, void *context), void *context,
                         uint64_t *rounds_short)
{
    struct turn *turn = turns->first, *found = NULL;
    *rounds_short = 0;
    if (!turn)
        return NULL;
    do {
        if (!can_use(turn, context))
            continue;
        int64_t us = deficit_us(turns, turn);
        uint64_t rounds = us > 0 ? 0 : (uint64_t)-us / TURNS_QUANTUM_US + 1;
        if (!found || rounds < *rounds_short) {
            found = turn;
            *rounds_short = rounds;
        }
        if (rounds == 0)
            return found;
    } while ((turn = turn->next) != turns->first);
    return found;
}

struct turn *turns_peek(const struct turns *turns,
                        bool (*can_use)(const struct turn *turn, void *context), void *context)
{
    uint64_t rounds_short;
    return find(turns, can_use, context, &rounds_short);
}

struct turn *turns_next(struct turns *turns,
                        bool (*can_use)(const struct turn *turn, void *context), void *context)
{
    uint64_t rounds_short;
    struct turn *turn = find(turns, can_use, context, &rounds_short);
    if (!turn)
        return NULL;
    turns->round += rounds_short;
    turn->deficit_us = deficit_us(turns, turn);
    turn->round = turns->round;
    turns->first = turn;
    return turn;
}
