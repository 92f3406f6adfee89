#include "server/assets/account.h"

#include <assert.h>

void account_init(struct account *account, struct account *parent, uint64_t limit)
{
    *account = (struct account){.parent = parent, .limit = limit};
}

void account_charge(struct account *account, enum account_class class, uint64_t bytes)
{
    for (; account; account = account->parent)
        account->used[class] += bytes;
}

void account_refund(struct account *account, enum account_class class, uint64_t bytes)
{
    for (; account; account = account->parent) {
        assert(account->used[class] >= bytes);
        account->used[class] -= bytes;
    }
}

uint64_t account_used(const struct account *account)
{
    uint64_t sum = 0;
    for (int c = 0; c < N_ACCOUNT_CLASSES; c++)
        sum += account->used[c];
    return sum;
}

uint64_t account_room(const struct account *account)
{
    uint64_t used = account_used(account);
    return used < account->limit ? account->limit - used : 0;
}
