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

static uint64_t due_us(const struct intake_party *party)
{
    return party->postponed_us < INTAKE_AHEAD_US ? 0 : party->postponed_us - INTAKE_AHEAD_US;
}

static bool is_due(const struct turn *turn, void *now_us)
{
    return due_us(turn->of) <= *(const uint64_t *)now_us;
}

void intake_postpone(struct intake_party *party, uint64_t now_us, uint64_t us)
{
    party->postponed_us = (party->postponed_us > now_us ? party->postponed_us : now_us) + us;
}

bool intake_is_postponed(const struct intake_source *source, uint64_t now_us)
{
    return due_us(source->party) > now_us;
}

uint64_t intake_due_us(const struct intake *intake)
{
    const struct turn *turn = intake->parties.first;
    uint64_t first_us = UINT64_MAX;
    for (const struct turn *end = turn; turn; turn = turn->next == end ? NULL : turn->next) {
        uint64_t us = due_us(turn->of);
        first_us = us < first_us ? us : first_us;
    }
    return first_us;
}

struct intake_source *intake_next(struct intake *intake, uint64_t now_us)
{
    struct turn *turn = turns_next(&intake->parties, is_due, &now_us);
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
