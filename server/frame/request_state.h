/* The states of a request. request_state.c has the table of allowed transitions, and
 * request_state_move() is the only function that changes a state.
 * Thread: the loop's. */
#ifndef SHEEN_FRAME_REQUEST_STATE_H
#define SHEEN_FRAME_REQUEST_STATE_H

#include <stdbool.h>

enum request_state {
    REQUEST_LOADING,   /* the initial state: the store builds assets, or a file is read */
    REQUEST_POLYGONS,  /* the store makes polygons for the device */
    REQUEST_PROGRAMS,  /* the device makes programs for the frame */
    REQUEST_QUEUED,    /* waits until the scheduler lets it draw a tile */
    REQUEST_PARKED,    /* waits for memory that other frames use */
    REQUEST_DRAWING,   /* the render thread draws a tile */
    REQUEST_PAINTING,  /* the pool paints false colour */
    REQUEST_ENCODING,  /* the pool or a worker process encodes the frame */
    REQUEST_IN_LINE,   /* a computation waits for others to end, or for memory */
    REQUEST_COMPUTING, /* slices of a computation run on the pool */
    REQUEST_HELD,      /* encoded; waits until the socket has taken an earlier frame */
    /* Answered early or without a client, while a thread or a build still works for it. */
    REQUEST_ABANDONED,
    REQUEST_ENDED, /* its memory is about to be freed */
};
enum { N_REQUEST_STATES = REQUEST_ENDED + 1 };

/* True if `to` may follow `from`. */
bool request_state_allows(enum request_state from, enum request_state to);

/* Changes *state. A transition that the table does not allow is a bug, and ends the program. */
void request_state_move(enum request_state *state, enum request_state to);

/* True if another thread works for a request in this state. (For an abandoned request: another
 * thread or the store.) */
bool request_state_is_busy(enum request_state state);

#endif
