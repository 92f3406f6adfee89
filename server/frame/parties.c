#include "server/frame/parties.h"

#include <stdlib.h>
#include <string.h>

struct party *party_get(struct parties *parties, const uint8_t identity[static OWNER_BYTES])
{
    /* An identity is a hash, so its first byte is uniform. */
    struct party_list *bucket = &parties->buckets[identity[0]];
    struct party *party;
    LIST_FOREACH (party, bucket, link)
        if (memcmp(party->identity, identity, OWNER_BYTES) == 0)
            return party_reference(party);
    party = malloc(sizeof *party);
    if (!party)
        return NULL;
    scheduler_add_party(&party->schedule);
    intake_add_party(&party->intake);
    party->n_computing = 0;
    memcpy(party->identity, identity, OWNER_BYTES);
    party->references = 1;
    LIST_INSERT_HEAD(bucket, party, link);
    return party;
}

struct party *party_reference(struct party *party)
{
    party->references++;
    return party;
}

void party_put(struct party *party)
{
    if (!party || --party->references > 0)
        return;
    LIST_REMOVE(party, link);
    free(party);
}
