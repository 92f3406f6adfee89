/* Fair turns: decides which member of a ring uses a shared thing next. The thing is used in pieces
 * of different length, and each member that wants it gets an equal part of the time (deficit round
 * robin: Shreedhar and Varghese, 1995).
 *
 * Plain data, embedded in the structs of its users: no allocation, no clock. Times are measured by
 * the caller.
 * Thread: one at a time. */
#ifndef SHEEN_BASE_TURNS_H
#define SHEEN_BASE_TURNS_H

#include <stdbool.h>
#include <stdint.h>

#define TURNS_QUANTUM_US 1000 /* the time of a member in one round */

/* A member. Zero it and set `of` before it joins for the first time. */
struct turn {
    void *of; /* the member's owner, for the caller */
    /* What it may still use in this round; negative if it used more than its part. */
    int64_t deficit_us;
    uint64_t round;               /* the round for which deficit_us is valid */
    struct turn *next, *previous; /* neighbours in the ring */
};

/* The ring of members that want the thing; zeroed: empty. */
struct turns {
    struct turn *first; /* the member whose turn it is; NULL: the ring is empty */
    uint64_t round;
    /* Unused time that a member can save up, beside its part of the present round. A member that uses
     * less than its share is then served at once and without a break, for so long. */
    int64_t saved_us;
};

/* A member joins as the last of the round, or leaves. A member with a negative deficit pays it back
 * while it is away, too. */
void turns_join(struct turns *turns, struct turn *turn);
void turns_leave(struct turns *turns, struct turn *turn);

/* The member whose turn it is, among those for which can_use() returns true; NULL if there is
 * none. */
struct turn *turns_next(struct turns *turns,
                        bool (*can_use)(const struct turn *turn, void *context), void *context);
/* The member that turns_next() would return now. The turn does not pass to it. */
struct turn *turns_peek(const struct turns *turns,
                        bool (*can_use)(const struct turn *turn, void *context), void *context);

/* The member has used `us` microseconds; negative: gives them back. */
static inline void turn_charge(struct turn *turn, int64_t us)
{
    turn->deficit_us -= us;
}

#endif
