/* The parties of the scheduler, one for each identity of which a client is connected or a frame is being
 * worked on. Thread: the loop's. */
#ifndef SHEEN_FRAME_PARTIES_H
#define SHEEN_FRAME_PARTIES_H

#include <sys/queue.h>

#include "server/base/owner.h"
#include "server/frame/scheduler.h"

struct party {
    struct schedule_party schedule;
    uint8_t identity[OWNER_BYTES];
    unsigned references; /* the module's own, as what follows */
    LIST_ENTRY(party) link;
};

LIST_HEAD(party_list, party);

enum { PARTY_BUCKETS = 256 };

struct parties { /* zeroed: nobody */
    struct party_list buckets[PARTY_BUCKETS];
};

/* The party of an identity, with another reference. NULL when memory is short. */
struct party *party_get(struct parties *parties, const uint8_t identity[static OWNER_BYTES]);
struct party *party_reference(struct party *party);
void party_put(struct party *party); /* NULL is safe */

#endif
