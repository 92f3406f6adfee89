#include "server/assets/store_shares.h"

#include <stdlib.h>
#include <string.h>

void store_shares_init(struct store_shares *shares, struct account *daemon)
{
    *shares = (struct store_shares){.daemon = daemon};
    LIST_INIT(&shares->list);
}

struct store_share *store_share_find(struct store_shares *shares,
                                     const uint8_t id[static OWNER_BYTES])
{
    struct store_share *share;
    LIST_FOREACH (share, &shares->list, link) {
        if (memcmp(share->id, id, OWNER_BYTES) != 0)
            continue;
        share->references++;
        return share;
    }
    return NULL;
}

struct store_share *store_share_get(struct store_shares *shares,
                                    const uint8_t id[static OWNER_BYTES])
{
    struct store_share *share = store_share_find(shares, id);
    if (share || !(share = calloc(1, sizeof *share)))
        return share;
    memcpy(share->id, id, sizeof share->id);
    account_init(&share->account, shares->daemon, ACCOUNT_NO_LIMIT);
    share->references = 1;
    LIST_INSERT_HEAD(&shares->list, share, link);
    shares->n++;
    return share;
}

void store_share_put(struct store_shares *shares, struct store_share *share)
{
    if (!share || --share->references > 0)
        return;
    LIST_REMOVE(share, link);
    shares->n--;
    free(share);
}

uint64_t store_share_held(const struct store_share *share, enum share_kind kind)
{
    return kind == SHARE_BYTES ? account_used(&share->account) : share->n_entries;
}

void store_shares_begin(struct store_shares *shares)
{
    shares->round++;
}

struct store_share *store_shares_next(struct store_shares *shares, enum share_kind kind,
                                      uint64_t least)
{
    struct store_share *largest = NULL, *share;
    LIST_FOREACH (share, &shares->list, link) {
        uint64_t held = store_share_held(share, kind);
        if (share->round != shares->round && held > least &&
            (!largest || held > store_share_held(largest, kind)))
            largest = share;
    }
    if (largest)
        largest->round = shares->round;
    return largest;
}
