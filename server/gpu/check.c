#include "server/gpu/gpu.h"

bool gpu_check(const char *doing, struct error *error)
{
    GLenum code = glGetError();
    if (code == GL_NO_ERROR)
        return true;
    while (glGetError() != GL_NO_ERROR)
        ;
    if (code == GL_OUT_OF_MEMORY)
        return error_set(error, ERROR_DEVICE, "the device is out of memory for %s", doing);
    return error_set(error, ERROR_DEVICE, "OpenGL error 0x%04x in %s", code, doing);
}
