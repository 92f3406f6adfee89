/* Who uses a thing next that many want and that is used in pieces of unequal length: each member of
 * the ring has an equal part of the time, whatever its pieces take (deficit round robin: Shreedhar
 * and Varghese, 1995).
 *
 * Plain data, embedded in its owners: no allocation, no clock; times are what the owner measured.
 * Thread: one at a time. */
#ifndef SHEEN_BASE_TURNS_H
#define SHEEN_BASE_TURNS_H

#include <stdbool.h>
#include <stdint.h>

#define TURNS_QUANTUM_US 1000 /* a member's part of one round */

/* A member. Zeroed, with `of` set, before it joins the first time. */
struct turn {
    void *of;           /* whose turn it is: the owner's */
    int64_t deficit_us; /* what it may still use in this round; negative: has used ahead */
    uint64_t round;     /* when deficit_us was right */
    struct turn *next, *previous; /* ring of those that want something */
};

/* The ring; zeroed is empty. */
struct turns {
    struct turn *first; /* whose turn it is; NULL: nobody wants anything */
    uint64_t round;
};

/* A member wants something, and comes last in the round; or wants nothing any more. One that has used
 * ahead pays it back also while it is away. */
void turns_join(struct turns *turns, struct turn *turn);
void turns_leave(struct turns *turns, struct turn *turn);

/* Whose turn it is, of those that can_use() says can use it now; NULL: nobody can. */
struct turn *turns_next(struct turns *turns,
                        bool (*can_use)(const struct turn *turn, void *context), void *context);

/* The member has used so much; negative gives back. */
static inline void turn_charge(struct turn *turn, int64_t us)
{
    turn->deficit_us -= us;
}

#endif
