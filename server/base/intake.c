#include "server/base/intake.h"

#include <stddef.h>

/* Charged times are multiplied by this factor, so that TURNS_QUANTUM_US stands for 125 us: a party waits
 * no longer than this for the turn of another. */
enum { SCALE = 8 };

void intake_add_party(struct intake_party *party)
{
    *party = (struct intake_party){.turn.of = party};
}

void intake_add_source(struct intake_source *source, struct intake_party *party,
                       void (*handle)(struct intake_source *source), void *owner)
{
    *source =
        (struct intake_source){.turn.of = source, .party = party, .owner = owner, .handle = handle};
}

void intake_ask(struct intake *intake, struct intake_source *source, bool asks)
{
    struct intake_party *party = source->party;
    if (source->asks == asks)
        return;
    source->asks = asks;
    if (asks) {
        if (!party->sources.first)
            turns_join(&intake->parties, &party->turn);
        turns_join(&party->sources, &source->turn);
        return;
    }
    turns_leave(&party->sources, &source->turn);
    if (!party->sources.first)
        turns_leave(&intake->parties, &party->turn);
}

void intake_move(struct intake *intake, struct intake_source *source, struct intake_party *party)
{
    bool asks = source->asks;
    intake_ask(intake, source, false);
    source->party = party;
    source->turn = (struct turn){.of = source};
    intake_ask(intake, source, asks);
}

static bool can_always(const struct turn *turn, void *context)
{
    (void)turn;
    (void)context;
    return true;
}

struct intake_source *intake_next(struct intake *intake)
{
    struct turn *turn = turns_next(&intake->parties, can_always, NULL);
    if (!turn)
        return NULL;
    struct intake_party *party = turn->of;
    return turns_next(&party->sources, can_always, NULL)->of;
}

void intake_charge(struct intake_source *source, uint64_t us)
{
    int64_t charge = (int64_t)(us > 0 ? us : 1) * SCALE;
    turn_charge(&source->turn, charge);
    turn_charge(&source->party->turn, charge);
}
