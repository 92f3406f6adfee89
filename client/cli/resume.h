/* When to connect again after a server has been lost, and when to give up. Pure: the time is the
 * caller's, of a clock that only goes forward. Thread: one. */
#ifndef SHEEN_CLIENT_RESUME_H
#define SHEEN_CLIENT_RESUME_H

#include <stdbool.h>
#include <stdint.h>

/* Servers that may be lost one after the other without an answer between them: a request that ends
 * whatever serves it must not go round for ever. */
#define RESUME_MAX_LOSSES 3u

struct resume {
    uint32_t limit_ms; /* from a loss to giving up */
    int64_t lost_ms;   /* when the latest was */
    uint32_t wait_ms;  /* before the try that comes next */
    unsigned n_losses; /* since the last answer */
    bool is_answered;  /* an answer has come in this command */
};

/* A server has been lost. False when that was one more than RESUME_MAX_LOSSES. */
bool resume_lost(struct resume *resume, int64_t now_ms);

/* How long to wait before the next try: 200 ms, then twice as long each time up to 2 s, the last
 * one when the time ends. False when it has ended. */
bool resume_wait(struct resume *resume, int64_t now_ms, uint32_t *wait_ms);

/* What a try may take, in milliseconds: what is left of the time, but at least a second. */
uint32_t resume_try_ms(const struct resume *resume, int64_t now_ms);

/* An answer has come: the next loss is the first again. */
void resume_answered(struct resume *resume);

#endif
