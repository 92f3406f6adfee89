#include "server/frame/error_code.h"

sheen_ErrorCode error_code_of(enum error_kind kind)
{
    switch (kind) {
    case ERROR_REQUEST:
        return sheen_ErrorCode_ERROR_REQUEST;
    case ERROR_MODEL:
        return sheen_ErrorCode_ERROR_MODEL;
    case ERROR_IMAGE:
        return sheen_ErrorCode_ERROR_IMAGE;
    case ERROR_DEVICE:
        return sheen_ErrorCode_ERROR_DEVICE;
    case ERROR_GPU_LOST:
        return sheen_ErrorCode_ERROR_GPU_LOST;
    case ERROR_NONE:
    case ERROR_SERVER:
        break;
    }
    return sheen_ErrorCode_ERROR_OVERLOADED;
}
