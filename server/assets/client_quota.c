#include "server/assets/client_quota.h"

#include <stdlib.h>

void client_quotas_init(struct client_quotas *quotas, struct account *daemon, uint64_t limit)
{
    quotas->daemon = daemon;
    quotas->limit = limit;
    for (int i = 0; i < CLIENT_QUOTA_BUCKETS; i++)
        LIST_INIT(&quotas->bucket[i]);
}

static struct client_quota_list *bucket_of(struct client_quotas *quotas, const struct peer *peer)
{
    uint64_t mixed = (peer->key[0] * 31 + peer->key[1]) * 0x9e3779b97f4a7c15u;
    return &quotas->bucket[mixed >> 56];
}

struct client_quota *client_quota_get(struct client_quotas *quotas, int fd)
{
    const struct peer peer = peer_identify(fd);
    struct client_quota_list *bucket = bucket_of(quotas, &peer);
    struct client_quota *quota;
    LIST_FOREACH (quota, bucket, link)
        if (quota->peer.key[0] == peer.key[0] && quota->peer.key[1] == peer.key[1])
            return client_quota_reference(quota);
    quota = malloc(sizeof *quota);
    if (!quota)
        return NULL;
    *quota = (struct client_quota){.peer = peer, .references = 1};
    account_init(&quota->account, quotas->daemon, quotas->limit);
    LIST_INSERT_HEAD(bucket, quota, link);
    return quota;
}

struct client_quota *client_quota_reference(struct client_quota *quota)
{
    quota->references++;
    return quota;
}

void client_quota_put(struct client_quota *quota)
{
    if (!quota || --quota->references > 0)
        return;
    LIST_REMOVE(quota, link);
    free(quota);
}
