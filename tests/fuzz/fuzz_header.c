/* The 16-byte headers of messages, one after the other, as in a stream. */
#include <string.h>

#include "protocol/frame.h"
#include "tests/fuzz/fuzz.h"

void fuzz_one(const uint8_t *bytes, size_t size)
{
    for (; size >= MESSAGE_HEADER_BYTES; bytes++, size--) {
        struct message_header header = {0};
        uint8_t again[MESSAGE_HEADER_BYTES];
        enum header_error wrong = message_header_decode(&header, bytes);
        if (wrong != HEADER_OK) {
            MUST(header_error_text(wrong)[0]);
            continue;
        }
        MUST(header.length <= message_max_length(header.type));
        MUST(message_type_name(header.type)[0]);
        message_header_encode(&header, again);
        MUST(memcmp(again, bytes, sizeof again) == 0);
    }
}
