#include "server/curves/computation.h"

bool computation_is_cancelled(struct computation *computation)
{
    if (computation->beat)
        computation->beat();
    return atomic_load_explicit(&computation->cancelled, memory_order_relaxed);
}

bool computation_repeats(struct computation *computation)
{
    return atomic_exchange(&computation->repeats, false);
}

bool computation_run(struct computation *computation, struct error *error)
{
    const struct computation_kind *kind = computation->kind;
    for (unsigned phase = 0; kind->stages[phase]; phase += !computation_repeats(computation)) {
        size_t n_slices = 0;
        if (!kind->begin(computation, phase, &n_slices, error))
            return false;
        for (size_t slice = 0; slice < n_slices && !computation->cancelled; slice++)
            kind->slice(computation, slice);
    }
    if (computation->cancelled)
        return error_set(error, ERROR_SERVER, "the computation was cancelled");
    return true;
}

void computation_destroy(struct computation *computation)
{
    if (computation)
        computation->kind->destroy(computation);
}
