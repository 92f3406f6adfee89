#include "server/assets/slices.h"

#include <stddef.h>

void slices_init(struct slices *slices, struct pool *pool)
{
    /* Two for each thread: one runs and one waits, so that no thread has to wait for the loop. */
    *slices = (struct slices){.pool = pool, .most_running = 2 * pool_threads(pool)};
}

void slices_join(struct slices *slices, struct slice_source *source)
{
    source->turn.of = source;
    source->is_dry = false;
    turns_join(&slices->builds, &source->turn);
}

void slices_leave(struct slices *slices, struct slice_source *source)
{
    turns_leave(&slices->builds, &source->turn);
}

void slices_done(struct slices *slices, struct slice_source *source, uint64_t took_us)
{
    slices->n_running--;
    source->is_dry = false;
    turn_charge(&source->turn, (int64_t)took_us - SLICE_US);
}

void slices_beat(void)
{
    pool_beat();
}

static bool is_wet(const struct turn *turn, void *context)
{
    (void)context;
    const struct slice_source *source = turn->of;
    return !source->is_dry;
}

void slices_start(struct slices *slices)
{
    struct turn *turn;
    while (slices->n_running < slices->most_running &&
           (turn = turns_next(&slices->builds, is_wet, NULL))) {
        struct slice_source *source = turn->of;
        struct task *slice = source->next(source);
        source->is_dry = !slice;
        if (!slice)
            continue;
        turn_charge(turn, SLICE_US); /* an estimate; slices_done() corrects it */
        slices->n_running++;
        pool_submit(slices->pool, slice, POOL_LATER);
    }
}
