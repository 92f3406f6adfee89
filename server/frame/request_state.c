#include "server/frame/request_state.h"

#include <stdlib.h>

#include "server/base/log.h"

#define TO(state) (1u << REQUEST_##state)

/* The table of transitions: every request can end, and every request that another thread works for
 * can be abandoned. */
static const struct {
    const char *name;
    unsigned next; /* states that may follow, one bit each */
    bool is_busy;
} STATES[N_REQUEST_STATES] = {
    [REQUEST_LOADING] = {"loading",
                         TO(POLYGONS) | TO(QUEUED) | TO(IN_LINE) | TO(ABANDONED) | TO(ENDED),
                         false},
    [REQUEST_POLYGONS] = {"polygons", TO(QUEUED) | TO(ENDED), false},
    [REQUEST_PROGRAMS] = {"programs", TO(QUEUED) | TO(ENDED), false},
    [REQUEST_QUEUED] = {"queued", TO(PARKED) | TO(DRAWING) | TO(ENDED), false},
    [REQUEST_PARKED] = {"parked", TO(QUEUED) | TO(ENDED), false},
    [REQUEST_DRAWING] = {"drawing",
                         TO(QUEUED) | TO(POLYGONS) | TO(PROGRAMS) | TO(PAINTING) | TO(ENCODING) |
                             TO(ABANDONED) | TO(ENDED),
                         true},
    [REQUEST_PAINTING] = {"painting", TO(ENCODING) | TO(ABANDONED), true},
    [REQUEST_ENCODING] = {"encoding", TO(HELD) | TO(ABANDONED) | TO(ENDED), true},
    [REQUEST_IN_LINE] = {"in line", TO(COMPUTING) | TO(ENDED), false},
    [REQUEST_COMPUTING] = {"computing", TO(ABANDONED) | TO(ENDED), true},
    [REQUEST_HELD] = {"held", TO(ENDED), false},
    [REQUEST_ABANDONED] = {"abandoned", TO(ENDED), true},
    [REQUEST_ENDED] = {"ended", 0, false},
};

bool request_state_allows(enum request_state from, enum request_state to)
{
    return STATES[from].next & 1u << to;
}

void request_state_move(enum request_state *state, enum request_state to)
{
    if (!request_state_allows(*state, to)) {
        log_event(LOG_ERROR, "a request's state is wrong", log_text("from", STATES[*state].name),
                  log_text("to", STATES[to].name));
        abort();
    }
    *state = to;
}

bool request_state_is_busy(enum request_state state)
{
    return STATES[state].is_busy;
}
