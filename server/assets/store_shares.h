/* Who holds how much of the store: each model and image counts for whoever brought it, whether it
 * is his alone or everybody's. So that nobody pushes out what others use, room is made by shares.
 * Thread: the loop's. */
#ifndef SHEEN_ASSETS_STORE_SHARES_H
#define SHEEN_ASSETS_STORE_SHARES_H

#include <stddef.h>
#include <stdint.h>

#define HOLDER_ID_BYTES 32 /* an identity's: access.h */

/* Of what there is so much and no more. */
enum holding { HOLDING_BYTES, HOLDING_ASSETS, N_HOLDINGS };

struct holder {
    uint8_t id[HOLDER_ID_BYTES];
    size_t held[N_HOLDINGS]; /* bytes: what his assets are charged with */
    unsigned references;     /* one for each asset, and for who works with it */
    uint64_t round;          /* the module's own, as all of: */
    struct holder *next;
};

/* Those that hold something. All zero before the first use. */
struct holders {
    struct holder *first;
    size_t n;
    uint64_t round;
};

/* With another reference. NULL when memory is short. */
struct holder *holder_get(struct holders *holders, const uint8_t id[static HOLDER_ID_BYTES]);
void holder_put(struct holders *holders, struct holder *holder); /* NULL is safe */
/* With another reference. NULL: he holds nothing. */
struct holder *holder_find(struct holders *holders, const uint8_t id[static HOLDER_ID_BYTES]);

/* Each holder once, those with most first: begin, then next until it is NULL. It leaves out who
 * holds no more than `share` by then. */
void holders_begin(struct holders *holders);
struct holder *holders_next(struct holders *holders, enum holding what, size_t share);

#endif
