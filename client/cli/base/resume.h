/* Decides when to reconnect after the loss of a server, and when to give up. Pure: the caller
 * passes the time of a monotonic clock.
 * Thread: one. */
#ifndef SHEEN_CLIENT_RESUME_H
#define SHEEN_CLIENT_RESUME_H

#include <stdbool.h>
#include <stdint.h>

/* The number of servers that may be lost in a row without an answer in between: a request that
 * crashes every server must not be repeated for ever. */
#define RESUME_MAX_LOSSES 3u

struct resume {
    uint32_t limit_ms; /* time from a loss to giving up */
    int64_t lost_ms;   /* time of the latest loss */
    uint32_t wait_ms;  /* waiting time before the next try */
    unsigned n_losses; /* losses since the latest answer */
    bool is_answered;  /* this command has received an answer */
};

/* A server was lost. False if that exceeds RESUME_MAX_LOSSES. */
bool resume_lost(struct resume *resume, int64_t now_ms);

/* Gets the time to wait before the next try: 200 ms, then doubled each time up to 2 s; the last try
 * comes when the time ends. False if the time has ended. */
bool resume_wait(struct resume *resume, int64_t now_ms, uint32_t *wait_ms);

/* How long a try may take, in milliseconds: the rest of the time, but at least a second. */
uint32_t resume_try_ms(const struct resume *resume, int64_t now_ms);

/* An answer has come: the next loss counts as the first again. */
void resume_answered(struct resume *resume);

#endif
