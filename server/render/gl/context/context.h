/* The GL context that there is now, and whether it is lost: by a reset, or by work that does not
 * end. GL names of a context that is lost went with it. GL thread. */
#ifndef SHEEN_RENDER_GL_CONTEXT_CONTEXT_H
#define SHEEN_RENDER_GL_CONTEXT_CONTEXT_H

#include <stdint.h>

#include "server/render/gl/context/egl.h"

/* Which context an object's GL names are of. Names of an earlier one are dropped, never deleted:
 * they may be another object's by now. */
typedef uint32_t context_number; /* from 1; 0: of none, the object is not on the device */

struct context {
    struct egl egl;
    context_number number;
    bool is_lost;              /* no GL call is allowed then but for opening another context */
    void (*lost)(void *owner); /* as renderer_options.lost */
    void *owner;
};

/* Has the context been lost? Stays true until another is opened. */
bool context_check_lost(struct context *context);
/* Marks the context as lost and tells its owner. */
void context_lose(struct context *context);
/* Waits for the device. False when the context is lost. A device that does not finish in 2 s counts
 * as lost; a software device may take any time. */
bool context_wait(struct context *context);
/* Are names of this number of the context that there is? */
static inline bool context_is_current(const struct context *context, context_number number)
{
    return number == context->number && !context->is_lost;
}

#endif
