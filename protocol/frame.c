#include "protocol/frame.h"

#include "protocol/limits.h"

static const struct {
    const char *name;
    uint32_t max_length;
} TYPES[MESSAGE_TYPES] = {
    [MESSAGE_HELLO] = {"HELLO", PROTOCOL_MAX_SMALL_BODY_BYTES},
    [MESSAGE_HELLO_OK] = {"HELLO_OK", PROTOCOL_MAX_SMALL_BODY_BYTES},
    [MESSAGE_UPLOAD_BEGIN] = {"UPLOAD_BEGIN", PROTOCOL_MAX_SMALL_BODY_BYTES},
    [MESSAGE_UPLOAD_CHUNK] = {"UPLOAD_CHUNK", PROTOCOL_MAX_CHUNK_BYTES},
    [MESSAGE_UPLOAD_STATE] = {"UPLOAD_STATE", PROTOCOL_MAX_SMALL_BODY_BYTES},
    [MESSAGE_MODEL_QUERY] = {"MODEL_QUERY", PROTOCOL_MAX_SMALL_BODY_BYTES},
    [MESSAGE_MODEL_INFO] = {"MODEL_INFO", PROTOCOL_MAX_LARGE_BODY_BYTES},
    [MESSAGE_RENDER] = {"RENDER", PROTOCOL_MAX_LARGE_BODY_BYTES},
    [MESSAGE_FRAME] = {"FRAME", PROTOCOL_MAX_LARGE_BODY_BYTES},
    [MESSAGE_DATA] = {"DATA", PROTOCOL_MAX_DATA_BYTES},
    [MESSAGE_PROGRESS] = {"PROGRESS", PROTOCOL_MAX_SMALL_BODY_BYTES},
    [MESSAGE_STATS_QUERY] = {"STATS_QUERY", 0},
    [MESSAGE_STATS] = {"STATS", PROTOCOL_MAX_SMALL_BODY_BYTES},
    [MESSAGE_ERROR] = {"ERROR", PROTOCOL_MAX_SMALL_BODY_BYTES},
    [MESSAGE_SUPERSEDED] = {"SUPERSEDED", PROTOCOL_MAX_SMALL_BODY_BYTES},
    [MESSAGE_CANCEL] = {"CANCEL", 0},
    [MESSAGE_FIND_BREAKS] = {"FIND_BREAKS", PROTOCOL_MAX_LARGE_BODY_BYTES},
    [MESSAGE_BREAKS] = {"BREAKS", PROTOCOL_MAX_LARGE_BODY_BYTES},
    [MESSAGE_COMPARE] = {"COMPARE", PROTOCOL_MAX_LARGE_BODY_BYTES},
    [MESSAGE_COMPARED] = {"COMPARED", PROTOCOL_MAX_LARGE_BODY_BYTES},
    [MESSAGE_TRACE_LINES] = {"TRACE_LINES", PROTOCOL_MAX_LARGE_BODY_BYTES},
    [MESSAGE_CURVES] = {"CURVES", PROTOCOL_MAX_LARGE_BODY_BYTES},
};

static const uint8_t MAGIC[4] = {'S', 'H', 'E', 'N'};

static void put_u32(uint8_t *bytes, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        bytes[i] = (uint8_t)(value >> (8 * i));
}

static uint32_t get_u32(const uint8_t *bytes)
{
    return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 |
           (uint32_t)bytes[3] << 24;
}

void message_header_encode(const struct message_header *header,
                           uint8_t bytes[static MESSAGE_HEADER_BYTES])
{
    for (int i = 0; i < 4; i++)
        bytes[i] = MAGIC[i];
    bytes[4] = header->major;
    bytes[5] = header->type;
    bytes[6] = (uint8_t)header->flags;
    bytes[7] = (uint8_t)(header->flags >> 8);
    put_u32(bytes + 8, header->length);
    put_u32(bytes + 12, header->seq);
}

enum header_error message_header_decode(struct message_header *header,
                                        const uint8_t bytes[static MESSAGE_HEADER_BYTES])
{
    for (int i = 0; i < 4; i++)
        if (bytes[i] != MAGIC[i])
            return HEADER_BAD_MAGIC;
    *header = (struct message_header){
        .major = bytes[4],
        .type = bytes[5],
        .flags = (uint16_t)(bytes[6] | bytes[7] << 8),
        .length = get_u32(bytes + 8),
        .seq = get_u32(bytes + 12),
    };
    if (header->major != PROTOCOL_MAJOR)
        return HEADER_BAD_MAJOR;
    if (header->type >= MESSAGE_TYPES || !TYPES[header->type].name)
        return HEADER_BAD_TYPE;
    if (header->length > TYPES[header->type].max_length)
        return HEADER_TOO_LONG;
    return HEADER_OK;
}

uint32_t message_max_length(uint8_t type)
{
    return type < MESSAGE_TYPES ? TYPES[type].max_length : 0;
}

const char *message_type_name(uint8_t type)
{
    return type < MESSAGE_TYPES && TYPES[type].name ? TYPES[type].name : "unknown";
}

const char *header_error_text(enum header_error error)
{
    switch (error) {
    case HEADER_OK:
        return "no error";
    case HEADER_BAD_MAGIC:
        return "the bytes do not begin with SHEN: the peer does not speak sheen's protocol";
    case HEADER_BAD_MAJOR:
        return "the peer speaks another major version of sheen's protocol";
    case HEADER_BAD_TYPE:
        return "the message type is unknown";
    case HEADER_TOO_LONG:
        return "the message is longer than its type allows";
    }
    return "unknown header error";
}
