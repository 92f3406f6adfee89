#include "server/render/gl/stage_clock.h"

#include "server/base/clock.h"
#include "server/render/gl/device_internal.h"
#include "server/render/gl/context/quirks.h"

bool stage_clock_by_device(const struct gl_renderer *r)
{
    GLint bits = 0;
    glGetQueryiv(GL_TIMESTAMP, GL_QUERY_COUNTER_BITS, &bits);
    return bits >= 32 &&
           (tells_device_times(r->context.egl.software) || r->base.options.device_times);
}

void stage_clock_init(struct gl_renderer *r)
{
    if (r->base.info.timed_by_device)
        glCreateQueries(GL_TIMESTAMP, 2 * MAX_CLOCKED_STAGES, &r->clock.mark[0][0]);
}

void stage_clock_begin(struct gl_renderer *r)
{
    r->clock.n = 0;
    r->clock.since_us = clock_now_us();
}

void stage_clock_start(struct gl_renderer *r)
{
    if (r->base.info.timed_by_device)
        glQueryCounter(r->clock.mark[r->clock.n][0], GL_TIMESTAMP);
}

bool stage_clock_end(struct gl_renderer *r, uint64_t *stage)
{
    if (!r->base.info.timed_by_device)
        return stage_clock_wait(r, stage);
    glQueryCounter(r->clock.mark[r->clock.n][1], GL_TIMESTAMP);
    r->clock.stage[r->clock.n++] = stage;
    return true;
}

bool stage_clock_wait(struct gl_renderer *r, uint64_t *stage)
{
    bool ok = context_wait(&r->context);
    uint64_t now = clock_now_us();
    *stage += now - r->clock.since_us;
    r->clock.since_us = now;
    return ok;
}

bool stage_clock_read(struct gl_renderer *r)
{
    uint64_t waited = 0;
    if (!r->base.info.timed_by_device)
        return true;
    if (!stage_clock_wait(r, &waited))
        return false;
    for (int i = 0; i < r->clock.n; i++) {
        GLuint64 ns[2] = {0, 0};
        for (int k = 0; k < 2; k++)
            glGetQueryObjectui64v(r->clock.mark[i][k], GL_QUERY_RESULT, &ns[k]);
        /* Rounded up to a microsecond: a stage that ran took time. */
        if (ns[1] > ns[0])
            *r->clock.stage[i] += (ns[1] - ns[0] + 999) / 1000;
    }
    r->clock.n = 0;
    return true;
}
