#include "protocol/messages/message.h"

#include <pb_decode.h>
#include <pb_encode.h>
#include <string.h>

#define FITS(body, limit) _Static_assert((body) <= (limit), "the limit is below what nanopb writes")
FITS(MODEL_ID_BYTES + sheen_Hello_size, PROTOCOL_MAX_SMALL_BODY_BYTES);
FITS(sheen_HelloOk_size, PROTOCOL_MAX_SMALL_BODY_BYTES);
FITS(sheen_UploadBegin_size, PROTOCOL_MAX_SMALL_BODY_BYTES);
FITS(sheen_UploadState_size, PROTOCOL_MAX_SMALL_BODY_BYTES);
FITS(sheen_ModelQuery_size, PROTOCOL_MAX_SMALL_BODY_BYTES);
FITS(sheen_ModelInfo_size, PROTOCOL_MAX_LARGE_BODY_BYTES);
FITS(sheen_Render_size, PROTOCOL_MAX_LARGE_BODY_BYTES);
FITS(sheen_Frame_size, PROTOCOL_MAX_LARGE_BODY_BYTES);
FITS(sheen_FindBreaks_size, PROTOCOL_MAX_LARGE_BODY_BYTES);
FITS(sheen_Breaks_size, PROTOCOL_MAX_LARGE_BODY_BYTES);
FITS(sheen_Compare_size, PROTOCOL_MAX_LARGE_BODY_BYTES);
FITS(sheen_Compared_size, PROTOCOL_MAX_LARGE_BODY_BYTES);
FITS(sheen_TraceLines_size, PROTOCOL_MAX_LARGE_BODY_BYTES);
FITS(sheen_Curves_size, PROTOCOL_MAX_LARGE_BODY_BYTES);
FITS(sheen_Superseded_size, PROTOCOL_MAX_SMALL_BODY_BYTES);
FITS(sheen_Progress_size, PROTOCOL_MAX_SMALL_BODY_BYTES);
FITS(sheen_Stats_size, PROTOCOL_MAX_SMALL_BODY_BYTES);
FITS(sheen_Error_size, PROTOCOL_MAX_SMALL_BODY_BYTES);

const pb_msgdesc_t *message_fields(uint8_t type)
{
    switch (type) {
    case MESSAGE_HELLO_OK:
        return sheen_HelloOk_fields;
    case MESSAGE_UPLOAD_BEGIN:
        return sheen_UploadBegin_fields;
    case MESSAGE_UPLOAD_STATE:
        return sheen_UploadState_fields;
    case MESSAGE_MODEL_QUERY:
        return sheen_ModelQuery_fields;
    case MESSAGE_MODEL_INFO:
        return sheen_ModelInfo_fields;
    case MESSAGE_RENDER:
        return sheen_Render_fields;
    case MESSAGE_FRAME:
        return sheen_Frame_fields;
    case MESSAGE_PROGRESS:
        return sheen_Progress_fields;
    case MESSAGE_STATS:
        return sheen_Stats_fields;
    case MESSAGE_ERROR:
        return sheen_Error_fields;
    case MESSAGE_SUPERSEDED:
        return sheen_Superseded_fields;
    case MESSAGE_FIND_BREAKS:
        return sheen_FindBreaks_fields;
    case MESSAGE_BREAKS:
        return sheen_Breaks_fields;
    case MESSAGE_COMPARE:
        return sheen_Compare_fields;
    case MESSAGE_COMPARED:
        return sheen_Compared_fields;
    case MESSAGE_TRACE_LINES:
        return sheen_TraceLines_fields;
    case MESSAGE_CURVES:
        return sheen_Curves_fields;
    default:
        return NULL;
    }
}

/* Encodes `body` behind a header and `prefix` bytes, which the caller fills in. */
static bool encode(uint8_t type, uint32_t seq, size_t prefix, const pb_msgdesc_t *fields,
                   const void *body, uint8_t *buffer, size_t capacity, size_t *length)
{
    size_t start = MESSAGE_HEADER_BYTES + prefix;
    if (capacity < start)
        return false;
    size_t written = 0;
    if (fields) {
        pb_ostream_t stream = pb_ostream_from_buffer(buffer + start, capacity - start);
        if (!pb_encode(&stream, fields, body))
            return false;
        written = stream.bytes_written;
    }
    if (prefix + written > message_max_length(type))
        return false;
    const struct message_header header = {
        .major = PROTOCOL_MAJOR,
        .type = type,
        .length = (uint32_t)(prefix + written),
        .seq = seq,
    };
    message_header_encode(&header, buffer);
    *length = start + written;
    return true;
}

bool message_encode(uint8_t type, uint32_t seq, const void *body, uint8_t *buffer, size_t capacity,
                    size_t *length)
{
    const pb_msgdesc_t *fields = message_fields(type);
    if (!fields && type != MESSAGE_STATS_QUERY && type != MESSAGE_CANCEL)
        return false;
    return encode(type, seq, 0, fields, body, buffer, capacity, length);
}

bool message_hello_encode(uint32_t seq, const uint8_t model_id[static MODEL_ID_BYTES],
                          const sheen_Hello *hello, uint8_t *buffer, size_t capacity,
                          size_t *length)
{
    if (!encode(MESSAGE_HELLO, seq, MODEL_ID_BYTES, sheen_Hello_fields, hello, buffer, capacity,
                length))
        return false;
    memcpy(buffer + MESSAGE_HEADER_BYTES, model_id, MODEL_ID_BYTES);
    return true;
}

/* Refuses texts with a zero byte: nanopb would keep hidden bytes behind it. */
static bool decode(uint8_t type, const uint8_t *bytes, size_t length, size_t prefix,
                   const pb_msgdesc_t *fields, void *body)
{
    char fault[MESSAGE_TEXT_BYTES];
    pb_istream_t stream = pb_istream_from_buffer(bytes + prefix, length - prefix);
    return pb_decode(&stream, fields, body) && !message_find_fault(type, bytes, length, fault);
}

bool message_decode(uint8_t type, const uint8_t *bytes, size_t length, void *body)
{
    const pb_msgdesc_t *fields = message_fields(type);
    return fields && decode(type, bytes, length, 0, fields, body);
}

bool message_hello_decode(const uint8_t *bytes, size_t length,
                          uint8_t model_id[static MODEL_ID_BYTES], sheen_Hello *hello)
{
    if (length < MODEL_ID_BYTES)
        return false;
    memcpy(model_id, bytes, MODEL_ID_BYTES);
    return decode(MESSAGE_HELLO, bytes, length, MODEL_ID_BYTES, sheen_Hello_fields, hello);
}
