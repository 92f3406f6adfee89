/* The parties that share the device and the event loop: one for each identity that has a connected
 * client or a frame in progress. Counted by references.
 * Thread: the loop's. */
#ifndef SHEEN_FRAME_PARTIES_H
#define SHEEN_FRAME_PARTIES_H

#include <sys/queue.h>

#include "server/base/owner.h"
#include "server/frame/scheduler.h"
#include "server/base/intake.h"

struct party {
    struct schedule_party schedule;
    struct intake_party intake;
    unsigned n_computing; /* computations of the party that run now */
    uint8_t identity[OWNER_BYTES];
    unsigned references; /* private to parties.c, like what follows */
    LIST_ENTRY(party) link;
};

LIST_HEAD(party_list, party);

enum { PARTY_BUCKETS = 256 };

struct parties { /* zeroed: empty */
    struct party_list buckets[PARTY_BUCKETS];
};

/* The party of an identity, made if needed; adds a reference. NULL when memory is short. */
struct party *party_get(struct parties *parties, const uint8_t identity[static OWNER_BYTES]);
/* Adds a reference; returns `party`. */
struct party *party_reference(struct party *party);
void party_put(struct party *party); /* drops a reference; NULL is safe */

#endif
