/* Decides which connection handles input next. A source (a connection) asks while it has input. Each
 * party (all sources of one identity) has an equal part of the loop's time, and of this part each of its
 * sources has an equal part (turns.h), however many sources a party has and however much they send. In
 * its turn a source handles one message. After INTAKE_BATCH_US the loop first looks for other events, so
 * that the finished work of other threads never waits behind a queue of messages.
 *
 * Requests that replace each other before they are drawn make the loop work for nothing, and on a machine
 * with few processors the loop takes that time from the device. intake_postpone() therefore limits how
 * many of them a party has read in a second.
 *
 * Bookkeeping over nodes embedded in their owners; no allocation. Thread: the loop's. */
#ifndef SHEEN_BASE_INTAKE_H
#define SHEEN_BASE_INTAKE_H

#include <stdbool.h>
#include <stdint.h>

#include "server/base/turns.h"

/* How long input is handled before the loop looks for other events. A message takes about 10 us, a
 * chunk of an upload up to 500 us. */
#define INTAKE_BATCH_US 250u

/* How far intake_postpone() may run ahead of the clock before the party has to wait. */
#define INTAKE_AHEAD_US 50000u

struct intake_party { /* must outlive its sources */
    struct turn turn;
    struct turns sources;  /* those that ask */
    uint64_t postponed_us; /* the time on the loop's clock up to which the party is postponed */
};

struct intake_source {
    struct turn turn;
    struct intake_party *party;
    bool asks;
    void *owner;
    /* Handles one message. It may end any source, this one too, but must not free it. */
    void (*handle)(struct intake_source *source);
};

struct intake { /* zeroed: empty */
    struct turns parties;
};

void intake_add_party(struct intake_party *party);
void intake_add_source(struct intake_source *source, struct intake_party *party,
                       void (*handle)(struct intake_source *source), void *owner);
/* Moves the source to another party. */
void intake_move(struct intake *intake, struct intake_source *source, struct intake_party *party);

/* Says whether the source has input. May be called again with the same answer. */
void intake_ask(struct intake *intake, struct intake_source *source, bool asks);

/* Postpones the input of a party by `us`, from now or from the time up to which it is postponed already. The
 * party waits while that time is more than INTAKE_AHEAD_US away. */
void intake_postpone(struct intake_party *party, uint64_t now_us, uint64_t us);

/* Does the source's party have to wait? */
bool intake_is_postponed(const struct intake_source *source, uint64_t now_us);

/* The source whose turn it is; NULL: no source asks, or all their parties have to wait. */
struct intake_source *intake_next(struct intake *intake, uint64_t now_us);
/* The time from which on intake_next() has a source, 0 or a time in the past: now; UINT64_MAX: no source
 * asks. */
uint64_t intake_due_us(const struct intake *intake);
/* Charges the time that a turn took, also to a source that no longer asks. */
void intake_charge(struct intake_source *source, uint64_t us);

static inline bool intake_is_empty(const struct intake *intake)
{
    return !intake->parties.first;
}

#endif
