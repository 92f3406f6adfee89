#include "client/cli/base/resume.h"

#define FIRST_WAIT_MS 200u
#define LONGEST_WAIT_MS 2000u
#define SHORTEST_TRY_MS 1000

bool resume_lost(struct resume *resume, int64_t now_ms)
{
    resume->lost_ms = now_ms;
    resume->wait_ms = FIRST_WAIT_MS;
    return resume->n_losses++ < RESUME_MAX_LOSSES;
}

static int64_t left_ms(const struct resume *resume, int64_t now_ms)
{
    return resume->lost_ms + resume->limit_ms - now_ms;
}

bool resume_wait(struct resume *resume, int64_t now_ms, uint32_t *wait_ms)
{
    int64_t left = left_ms(resume, now_ms);
    if (left <= 0)
        return false;
    *wait_ms = resume->wait_ms < left ? resume->wait_ms : (uint32_t)left;
    resume->wait_ms *= 2;
    if (resume->wait_ms > LONGEST_WAIT_MS)
        resume->wait_ms = LONGEST_WAIT_MS;
    return true;
}

uint32_t resume_try_ms(const struct resume *resume, int64_t now_ms)
{
    int64_t left = left_ms(resume, now_ms);
    return left < SHORTEST_TRY_MS ? SHORTEST_TRY_MS : (uint32_t)left;
}

void resume_answered(struct resume *resume)
{
    resume->n_losses = 0;
    resume->is_answered = true;
}
