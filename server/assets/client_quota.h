/* What all connections of one identity (access.h) use together: their number, and the memory of
 * their uploads, long messages and frames. Stored models and images count elsewhere
 * (store_shares.h).
 * Thread: the loop's. */
#ifndef SHEEN_ASSETS_CLIENT_QUOTA_H
#define SHEEN_ASSETS_CLIENT_QUOTA_H

#include <stdint.h>
#include <sys/queue.h>

#include "server/assets/account.h"
#include "server/net/access.h"

struct client_quota {
    uint8_t identity[OWNER_BYTES];
    char name[IDENTITY_NAME_BYTES]; /* name of the identity */
    uint32_t n_connections;
    struct account account;
    unsigned references; /* private to client_quota.c, like what follows */
    LIST_ENTRY(client_quota) link;
};
LIST_HEAD(client_quota_list, client_quota);

#define CLIENT_QUOTA_BUCKETS 256
/* The quotas of all identities that are connected or whose frames are still being sent. */
struct client_quotas {
    struct account *daemon; /* parent of the quotas' accounts */
    uint64_t limit;         /* bytes for each identity, or ACCOUNT_NO_LIMIT */
    struct client_quota_list bucket[CLIENT_QUOTA_BUCKETS];
};

void client_quotas_init(struct client_quotas *quotas, struct account *daemon, uint64_t limit);

/* The quota of an identity, made if needed; adds a reference. NULL when memory is short. */
struct client_quota *client_quota_get(struct client_quotas *quotas,
                                      const struct identity *identity);
/* Adds a reference; returns `quota`. */
struct client_quota *client_quota_reference(struct client_quota *quota);
void client_quota_put(struct client_quota *quota); /* drops a reference; NULL is safe */

#endif
