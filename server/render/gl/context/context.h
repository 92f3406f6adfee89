/* The current GL context, and whether it is lost: by a reset, or by work that does not end. The GL
 * names of a lost context are invalid. GL thread. */
#ifndef SHEEN_RENDER_GL_CONTEXT_CONTEXT_H
#define SHEEN_RENDER_GL_CONTEXT_CONTEXT_H

#include <stdint.h>

#include "server/render/gl/context/egl.h"

/* The context of an object's GL names. Names of an earlier context are dropped, never deleted: in
 * the current context they may belong to another object. */
typedef uint32_t context_number; /* from 1; 0: the object is not on the device */

struct context {
    struct egl egl;
    context_number number;
    bool is_lost;              /* then no GL call is allowed, except to open another context */
    void (*lost)(void *owner); /* see renderer_options.lost */
    void *owner;
};

/* True if the context is lost; stays true until another is opened. */
bool context_check_lost(struct context *context);
/* Marks the context as lost and tells its owner. */
void context_lose(struct context *context);
/* Waits for the device. False if the context is lost. A device that does not finish in 2 s counts
 * as lost; a software device may take any time. */
bool context_wait(struct context *context);
/* True if names with this number belong to the current context. */
static inline bool context_is_current(const struct context *context, context_number number)
{
    return number == context->number && !context->is_lost;
}

#endif
