#include "server/render/gl/context/check.h"

#include <epoxy/gl.h>

bool gpu_check(const char *doing, struct error *error)
{
    GLenum code = glGetError();
    if (code == GL_NO_ERROR)
        return true;
    /* A lost context may return GL_CONTEXT_LOST for ever. */
    for (GLenum next = code; next != GL_NO_ERROR && next != GL_CONTEXT_LOST;)
        next = glGetError();
    if (code == GL_OUT_OF_MEMORY)
        return error_set(error, ERROR_DEVICE, "the device is out of memory for %s", doing);
    return error_set(error, ERROR_DEVICE, "OpenGL error 0x%04x in %s", code, doing);
}
