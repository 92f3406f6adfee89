#include "server/render/gl/context/context.h"

#include <epoxy/gl.h>

#include "server/base/fault.h"

/* The device counts as lost if the stages of a tile take longer than this. Tiles are sized for a
 * hundredth of it. */
#define LOST_AFTER_NS 2000000000u

void context_lose(struct context *context)
{
    context->is_lost = true;
    if (context->lost)
        context->lost(context->owner);
}

bool context_check_lost(struct context *context)
{
    if (!context->is_lost && (fault_at("gpu.lost") || glGetGraphicsResetStatus() != GL_NO_ERROR))
        context_lose(context);
    return context->is_lost;
}

bool context_wait(struct context *context)
{
    GLsync fence = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    GLenum came;
    bool late;
    do {
        came = glClientWaitSync(fence, GL_SYNC_FLUSH_COMMANDS_BIT, LOST_AFTER_NS);
        late = came == GL_TIMEOUT_EXPIRED || fault_at("gpu.fence");
    } while (came == GL_TIMEOUT_EXPIRED && context->egl.software);
    glDeleteSync(fence);
    if (late && !context->is_lost)
        context_lose(context);
    return !context_check_lost(context);
}
