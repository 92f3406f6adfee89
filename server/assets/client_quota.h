/* What all connections of one identity (access.h) take together: how many they are, and how much
 * memory their uploads, long messages and frames take. Models and images that are stored count
 * elsewhere (store_shares.h). Thread: the loop's. */
#ifndef SHEEN_ASSETS_CLIENT_QUOTA_H
#define SHEEN_ASSETS_CLIENT_QUOTA_H

#include <stdint.h>
#include <sys/queue.h>

#include "server/assets/account.h"
#include "server/net/access.h"

struct client_quota {
    uint8_t identity[OWNER_BYTES];
    char name[IDENTITY_NAME_BYTES]; /* the identity's */
    uint32_t n_connections;
    struct account account;
    unsigned references; /* the module's own, as what follows */
    LIST_ENTRY(client_quota) link;
};
LIST_HEAD(client_quota_list, client_quota);

#define CLIENT_QUOTA_BUCKETS 256
/* The quotas of all that are connected, or whose frames are still being sent. */
struct client_quotas {
    struct account *daemon; /* the accounts' parent */
    uint64_t limit;         /* bytes of one identity, or ACCOUNT_NO_LIMIT */
    struct client_quota_list bucket[CLIENT_QUOTA_BUCKETS];
};

void client_quotas_init(struct client_quotas *quotas, struct account *daemon, uint64_t limit);

/* The quota of an identity, with another reference. NULL when memory is short. */
struct client_quota *client_quota_get(struct client_quotas *quotas,
                                      const struct identity *identity);
struct client_quota *client_quota_reference(struct client_quota *quota);
void client_quota_put(struct client_quota *quota); /* NULL is safe */

#endif
