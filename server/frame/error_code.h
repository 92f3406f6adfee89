/* Maps an error of the server to the code of an ERROR message. Pure, any thread. */
#ifndef SHEEN_FRAME_ERROR_CODE_H
#define SHEEN_FRAME_ERROR_CODE_H

#include "protocol/messages/message.h"
#include "server/base/error.h"

sheen_ErrorCode error_code_of(enum error_kind kind);

#endif
