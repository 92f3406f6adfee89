/* What a request of computed numbers asks for, by its message's type. Plain data. */
#ifndef SHEEN_FRAME_COMPUTE_ASKED_H
#define SHEEN_FRAME_COMPUTE_ASKED_H

#include "protocol/messages/message.h"

union compute_asked {
    sheen_FindBreaks find_breaks;
    sheen_Compare compare;
    sheen_TraceLines trace_lines;
};

#endif
