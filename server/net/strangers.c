#include "server/net/strangers.h"

#include <stddef.h>

static bool is_same(const struct peer *a, const uint64_t key[static 2])
{
    return a->key[0] == key[0] && a->key[1] == key[1];
}

void strangers_init(struct strangers *strangers)
{
    TAILQ_INIT(&strangers->list);
}

/* --- penalties */

static struct stranger_penalty *find_penalty(struct strangers *strangers, const struct peer *peer)
{
    for (size_t i = 0; i < STRANGERS_MAX_PENALTIES; i++)
        if (strangers->penalties[i].until_us > 0 && is_same(peer, strangers->penalties[i].key))
            return &strangers->penalties[i];
    return NULL;
}

bool strangers_admits(const struct strangers *strangers, const struct peer *peer, uint64_t now_us)
{
    for (size_t i = 0; i < STRANGERS_MAX_PENALTIES; i++) {
        const struct stranger_penalty *penalty = &strangers->penalties[i];
        if (penalty->is_refused && penalty->until_us > now_us && is_same(peer, penalty->key))
            return false;
    }
    return true;
}

/* The penalty of this address, else the one that ends first, which is forgotten. */
static struct stranger_penalty *take_penalty(struct strangers *strangers, const struct peer *peer)
{
    struct stranger_penalty *penalty = find_penalty(strangers, peer);
    if (penalty)
        return penalty;
    penalty = &strangers->penalties[0];
    for (size_t i = 1; i < STRANGERS_MAX_PENALTIES; i++)
        if (strangers->penalties[i].until_us < penalty->until_us)
            penalty = &strangers->penalties[i];
    *penalty = (struct stranger_penalty){.key = {peer->key[0], peer->key[1]}};
    return penalty;
}

/* Adds to an address's penalty. True if the address is refused from now on. */
static bool punish(struct strangers *strangers, const struct strangers_limits *limits,
                   const struct peer *peer, uint64_t us, uint64_t now_us)
{
    if (limits->penalty_s == 0)
        return false;
    const uint64_t most_us = now_us + limits->penalty_s * 1000000;
    struct stranger_penalty *penalty = take_penalty(strangers, peer);
    if (penalty->until_us <= now_us) {
        penalty->until_us = now_us;
        penalty->is_refused = false;
    }
    penalty->until_us = penalty->until_us + us > most_us ? most_us : penalty->until_us + us;
    bool was_refused = penalty->is_refused;
    penalty->is_refused = was_refused || penalty->until_us - now_us >= STRANGERS_REFUSED_FROM_US;
    return penalty->is_refused && !was_refused;
}

/* --- coming and leaving */

static uint64_t count_of(const struct strangers *strangers, const struct peer *peer)
{
    uint64_t n = 0;
    const struct stranger *stranger;
    TAILQ_FOREACH (stranger, &strangers->list, link)
        n += is_same(&stranger->peer, peer->key);
    return n;
}

static bool is_before(const struct stranger *a, const struct stranger *b)
{
    for (int i = 0; i < 2; i++)
        if (a->peer.key[i] != b->peer.key[i])
            return a->peer.key[i] < b->peer.key[i];
    return a->number < b->number;
}

static struct stranger *merge(struct stranger *a, struct stranger *b)
{
    struct stranger *first = NULL, **end = &first;
    while (a && b) {
        struct stranger **from = is_before(a, b) ? &a : &b;
        *end = *from;
        *from = (*from)->next_sorted;
        end = &(*end)->next_sorted;
    }
    *end = a ? a : b;
    return first;
}

/* All strangers as a list in the order of addresses, those of one address in the order of their coming.
 * Merges lists of 1, 2, 4, ... strangers: n log n steps, whatever the addresses. */
static struct stranger *sort_by_address(const struct strangers *strangers)
{
    enum { LEVELS = 64 };
    struct stranger *lists[LEVELS] = {NULL}, *stranger;
    TAILQ_FOREACH (stranger, &strangers->list, link) {
        struct stranger *list = stranger;
        int level = 0;
        list->next_sorted = NULL;
        for (; lists[level]; level++) {
            list = merge(lists[level], list);
            lists[level] = NULL;
        }
        lists[level] = list;
    }
    struct stranger *all = NULL;
    for (int level = 0; level < LEVELS; level++)
        all = merge(lists[level], all);
    return all;
}

/* The address with most strangers; of several such addresses that of the oldest stranger. There is at
 * least one. */
static const struct peer *most_common(const struct strangers *strangers)
{
    const struct stranger *most = NULL, *first = sort_by_address(strangers), *next;
    uint64_t n = 0;
    for (; first; first = next) {
        uint64_t of_it = 0;
        for (next = first; next && is_same(&next->peer, first->peer.key); next = next->next_sorted)
            of_it++;
        if (of_it > n || (of_it == n && first->number < most->number)) {
            most = first;
            n = of_it;
        }
    }
    return &most->peer;
}

static struct stranger *first_to_leave(struct strangers *strangers, const struct peer *peer)
{
    struct stranger *stranger, *oldest = NULL;
    TAILQ_FOREACH (stranger, &strangers->list, link) {
        if (!is_same(&stranger->peer, peer->key))
            continue;
        if (stranger->is_silent(stranger))
            return stranger;
        oldest = oldest ? oldest : stranger;
    }
    return oldest;
}

struct stranger *strangers_enter(struct strangers *strangers, const struct strangers_limits *limits,
                                 struct stranger *stranger, uint64_t now_us)
{
    struct stranger *leaves = NULL;
    if (!stranger->is_exempt && count_of(strangers, &stranger->peer) >= limits->of_peer)
        leaves = first_to_leave(strangers, &stranger->peer);
    else if (strangers->n >= limits->all)
        leaves = first_to_leave(strangers, most_common(strangers));
    stranger->since_us = now_us;
    stranger->number = ++strangers->last_number;
    TAILQ_INSERT_TAIL(&strangers->list, stranger, link);
    strangers->n++;
    return leaves;
}

bool strangers_leave(struct strangers *strangers, const struct strangers_limits *limits,
                     struct stranger *stranger, enum stranger_end end, uint64_t now_us)
{
    TAILQ_REMOVE(&strangers->list, stranger, link);
    strangers->n--;
    struct stranger_penalty *penalty = find_penalty(strangers, &stranger->peer);
    if (end == STRANGER_ADMITTED && penalty)
        *penalty = (struct stranger_penalty){.until_us = 0};
    return end != STRANGER_ADMITTED && !stranger->is_exempt &&
           punish(strangers, limits, &stranger->peer,
                  end == STRANGER_WRONG ? STRANGERS_WRONG_US : STRANGERS_PENALTY_US, now_us);
}

uint64_t strangers_patience_us(const struct strangers *strangers,
                               const struct strangers_limits *limits, uint64_t handshake_us)
{
    bool is_crowded = strangers->n > limits->all / 2;
    return is_crowded && handshake_us > STRANGERS_HURRY_US ? STRANGERS_HURRY_US : handshake_us;
}
