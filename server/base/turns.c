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

/* Updates a member's deficit to the ring's current round. A member saves up no more than the ring
 * allows; one that used more than its part pays it back even while it wants nothing. */
static void settle(const struct turns *turns, struct turn *turn)
{
    uint64_t rounds = turns->round - turn->round;
    const int64_t most = TURNS_QUANTUM_US + turns->saved_us;
    turn->round = turns->round;
    turn->deficit_us =
        rounds > UINT32_MAX ? most : turn->deficit_us + (int64_t)rounds * TURNS_QUANTUM_US;
    if (turn->deficit_us > most)
        turn->deficit_us = most;
}

/* Goes once round the ring and returns the first member that can use the thing and has time left.
 * If none has, *rounds_short is the number of rounds until one has; 0: no member can use the
 * thing. */
static struct turn *once_round(struct turns *turns,
                               bool (*can_use)(const struct turn *turn, void *context),
                               void *context, uint64_t *rounds_short)
{
    struct turn *turn = turns->first;
    *rounds_short = 0;
    do {
        if (can_use(turn, context)) {
            settle(turns, turn);
            if (turn->deficit_us > 0)
                return turn;
            uint64_t rounds = (uint64_t)-turn->deficit_us / TURNS_QUANTUM_US + 1;
            if (*rounds_short == 0 || rounds < *rounds_short)
                *rounds_short = rounds;
        }
        turn = turn->next;
    } while (turn != turns->first);
    return NULL;
}

struct turn *turns_next(struct turns *turns,
                        bool (*can_use)(const struct turn *turn, void *context), void *context)
{
    uint64_t rounds_short;
    if (!turns->first)
        return NULL;
    struct turn *turn = once_round(turns, can_use, context, &rounds_short);
    if (!turn && rounds_short > 0) {
        turns->round += rounds_short;
        turn = once_round(turns, can_use, context, &rounds_short);
    }
    if (turn)
        turns->first = turn;
    return turn;
}
