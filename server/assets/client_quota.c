#include "server/assets/client_quota.h"

#include <stdlib.h>
#include <string.h>

void client_quotas_init(struct client_quotas *quotas, struct account *daemon, uint64_t limit)
{
    quotas->daemon = daemon;
    quotas->limit = limit;
    for (int i = 0; i < CLIENT_QUOTA_BUCKETS; i++)
        LIST_INIT(&quotas->bucket[i]);
}

struct client_quota *client_quota_get(struct client_quotas *quotas, const struct identity *identity)
{
    /* An identity is a hash, so its first byte is uniform. */
    struct client_quota_list *bucket = &quotas->bucket[identity->owner[0]];
    struct client_quota *quota;
    LIST_FOREACH (quota, bucket, link)
        if (memcmp(quota->identity, identity->owner, OWNER_BYTES) == 0)
            return client_quota_reference(quota);
    quota = malloc(sizeof *quota);
    if (!quota)
        return NULL;
    *quota = (struct client_quota){.references = 1};
    memcpy(quota->identity, identity->owner, OWNER_BYTES);
    memcpy(quota->name, identity->name, sizeof quota->name);
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
