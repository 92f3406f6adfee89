/* Where a request stands. Every state, and what may follow it, is in one table (request_state.c);
 * request_state_move() is the only way from one to another. Thread: the loop's. */
#ifndef SHEEN_FRAME_REQUEST_STATE_H
#define SHEEN_FRAME_REQUEST_STATE_H

#include <stdbool.h>

enum request_state {
    REQUEST_LOADING,  /* the store builds what it needs, or a file is read; a request begins here */
    REQUEST_POLYGONS, /* the store makes polygons for the device */
    REQUEST_QUEUED,   /* waits until the scheduler lets it draw a tile */
    REQUEST_PARKED,   /* waits for memory that other frames have */
    REQUEST_DRAWING,  /* the render thread draws a tile */
    REQUEST_PAINTING, /* the pool paints false colour */
    REQUEST_ENCODING, /* the pool or a worker process encodes the frame */
    REQUEST_HELD,     /* encoded, until the client's socket has taken an earlier frame */
    REQUEST_ABANDONED, /* answered early or without a client; somebody still works for it */
    REQUEST_ENDED,     /* its memory is about to be freed */
};
enum { N_REQUEST_STATES = REQUEST_ENDED + 1 };

/* May `to` follow `from`? */
bool request_state_allows(enum request_state from, enum request_state to);

/* Moves *state on. A move that the table does not allow is an error of the program, which ends
 * here. */
void request_state_move(enum request_state *state, enum request_state to);

/* Does another thread work for a request in this state? (For an abandoned one it does, or the store
 * does.) */
bool request_state_is_busy(enum request_state state);

#endif
