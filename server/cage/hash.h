/* A keyed 64-bit hash for tables over data from strangers. The seed is secret, so nobody can
 * prepare keys that all fall into one slot. Results must not depend on the order of slots, which
 * changes with the seed.
 * Any thread. */
#ifndef SHEEN_CAGE_HASH_H
#define SHEEN_CAGE_HASH_H

#include <stdint.h>
#include <sys/random.h>

static inline uint64_t hash_seed(void)
{
    uint64_t seed = 0x9e3779b97f4a7c15u;
    /* Without entropy the seed is a constant: a hostile file can then make a table slow, but never
     * wrong. */
    if (getrandom(&seed, sizeof seed, GRND_NONBLOCK) != (ssize_t)sizeof seed)
        seed ^= 0xd1b54a32d192ed03u;
    return seed;
}

/* The finaliser of splitmix64 (Steele, Lea, Flood 2014). */
static inline uint64_t hash_mix(uint64_t key, uint64_t seed)
{
    uint64_t x = key ^ seed;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

#endif
