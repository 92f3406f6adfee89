/* message_find_fault(): nanopb reports only that a body breaks the schema; this file finds
 * where. */
#include "protocol/messages/message.h"

#include <inttypes.h>
#include <pb_common.h>
#include <pb_decode.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* The names of the schema's fields, which nanopb's descriptors do not have. Each list ends with tag
 * 0. */
struct field_name {
    uint32_t tag;
    const char *name;
};
#define ROW(context, storage, rule, kind, name, tag) {tag, #name},
#define NAMES(message)                                                                             \
    static const struct field_name message##_names[] = {message##_FIELDLIST(ROW, 0){0, NULL}}
NAMES(sheen_Vec3);
NAMES(sheen_Colour);
NAMES(sheen_Hello);
NAMES(sheen_HelloOk);
NAMES(sheen_UploadBegin);
NAMES(sheen_UploadState);
NAMES(sheen_ModelQuery);
NAMES(sheen_ValenceCount);
NAMES(sheen_Finding);
NAMES(sheen_ModelInfo);
NAMES(sheen_Camera);
NAMES(sheen_Pattern);
NAMES(sheen_Light);
NAMES(sheen_Lines);
NAMES(sheen_Show);
NAMES(sheen_Window);
NAMES(sheen_Render);
NAMES(sheen_Times);
NAMES(sheen_Frame);
NAMES(sheen_FindBreaks);
NAMES(sheen_Breaks);
NAMES(sheen_ComparedPlace);
NAMES(sheen_ComparedMeasure);
NAMES(sheen_ComparedSide);
NAMES(sheen_Alignment);
NAMES(sheen_Compare);
NAMES(sheen_Compared);
NAMES(sheen_TraceLines);
NAMES(sheen_Curves);
NAMES(sheen_Progress);
NAMES(sheen_Latency);
NAMES(sheen_Stats);
NAMES(sheen_Error);

#define MESSAGE(message)                                                                           \
    {                                                                                              \
        message##_fields, message##_names                                                          \
    }
static const struct {
    const pb_msgdesc_t *fields;
    const struct field_name *names;
} MESSAGES[] = {
    MESSAGE(sheen_Vec3),          MESSAGE(sheen_Colour),          MESSAGE(sheen_Hello),
    MESSAGE(sheen_HelloOk),       MESSAGE(sheen_UploadBegin),     MESSAGE(sheen_UploadState),
    MESSAGE(sheen_ModelQuery),    MESSAGE(sheen_ValenceCount),    MESSAGE(sheen_ModelInfo),
    MESSAGE(sheen_Finding),       MESSAGE(sheen_Camera),          MESSAGE(sheen_Pattern),
    MESSAGE(sheen_Light),         MESSAGE(sheen_Lines),           MESSAGE(sheen_Show),
    MESSAGE(sheen_Window),        MESSAGE(sheen_Render),          MESSAGE(sheen_Times),
    MESSAGE(sheen_Frame),         MESSAGE(sheen_Progress),        MESSAGE(sheen_Latency),
    MESSAGE(sheen_Stats),         MESSAGE(sheen_FindBreaks),      MESSAGE(sheen_Breaks),
    MESSAGE(sheen_ComparedPlace), MESSAGE(sheen_ComparedMeasure), MESSAGE(sheen_ComparedSide),
    MESSAGE(sheen_Alignment),     MESSAGE(sheen_Compare),         MESSAGE(sheen_Compared),
    MESSAGE(sheen_TraceLines),    MESSAGE(sheen_Curves),          MESSAGE(sheen_Error),
};

#define MAX_TAG 64    /* larger than every tag in sheen.proto */
#define PATH_BYTES 96 /* room for the longest path of a field there */

/* One message of the body, which may be nested in others. */
struct part {
    const pb_msgdesc_t *fields;
    const char *path; /* names of the fields that it is nested in, each followed by '.' */
    char *text;       /* the fault is written here: MESSAGE_TEXT_BYTES */
};

static const char *name_of(const pb_msgdesc_t *fields, uint32_t tag)
{
    for (size_t i = 0; i < sizeof MESSAGES / sizeof *MESSAGES; i++)
        for (const struct field_name *name = MESSAGES[i].names; name->tag; name++)
            if (MESSAGES[i].fields == fields && name->tag == tag)
                return name->name;
    return "a field";
}

static bool find_fault(const struct part *part, pb_istream_t *stream);

static bool __attribute__((format(printf, 3, 4)))
fault_at(const struct part *part, const pb_field_iter_t *field, const char *format, ...)
{
    va_list arguments;
    int n = snprintf(part->text, MESSAGE_TEXT_BYTES, "%s%s ", part->path,
                     name_of(part->fields, field->tag));
    va_start(arguments, format);
    vsnprintf(part->text + n, (size_t)(MESSAGE_TEXT_BYTES - n), format, arguments);
    va_end(arguments);
    return true;
}

static bool fault_within(const struct part *part, const pb_field_iter_t *field,
                         pb_istream_t *stream)
{
    char path[PATH_BYTES];
    snprintf(path, sizeof path, "%s%s.", part->path, name_of(part->fields, field->tag));
    const struct part inner = {field->submsg_desc, path, part->text};
    return find_fault(&inner, stream);
}

static bool has_nul(pb_istream_t *stream)
{
    pb_byte_t bytes[64];
    while (stream->bytes_left > 0) {
        size_t n = stream->bytes_left < sizeof bytes ? stream->bytes_left : sizeof bytes;
        if (!pb_read(stream, bytes, n) || memchr(bytes, 0, n))
            return true;
    }
    return false;
}

/* Checks a value with a length: a string, bytes, a message, or packed numbers. */
static bool fault_in_bytes(const struct part *part, const pb_field_iter_t *field,
                           pb_istream_t *stream, uint32_t *count)
{
    size_t length = stream->bytes_left, size = field->data_size;
    switch (PB_LTYPE(field->type)) {
    case PB_LTYPE_STRING: /* without the final 0, which is not sent */
        ++*count;
        if (length >= size)
            return fault_at(part, field, "has %zu bytes; it may have at most %zu", length,
                            size - 1);
        return has_nul(stream) && fault_at(part, field, "has a zero byte; texts have none");
    case PB_LTYPE_FIXED_LENGTH_BYTES:
        ++*count;
        return length != size &&
               fault_at(part, field, "has %zu bytes; it must have %zu", length, size);
    case PB_LTYPE_SUBMESSAGE:
        ++*count;
        return fault_within(part, field, stream);
    default:
        *count += (uint32_t)(length / size);
        return false;
    }
}

/* Reads one value of a field. True if it has a fault. *end: the value cannot be read. */
static bool fault_in_value(const struct part *part, const pb_field_iter_t *field,
                           pb_wire_type_t wire, pb_istream_t *stream, uint32_t *count, bool *end)
{
    pb_istream_t inner;
    uint64_t number;
    if (wire == PB_WT_STRING) {
        *end = !pb_make_string_substream(stream, &inner);
        if (*end || fault_in_bytes(part, field, &inner, count))
            return !*end;
        *end = !pb_close_string_substream(stream, &inner);
        return false;
    }
    ++*count;
    if (wire != PB_WT_VARINT) {
        *end = !pb_skip_field(stream, wire);
        return false;
    }
    *end = !pb_decode_varint(stream, &number);
    bool is_uint32 = PB_LTYPE(field->type) == PB_LTYPE_UVARINT && field->data_size == 4;
    return !*end && is_uint32 && number > UINT32_MAX &&
           fault_at(part, field, "is %" PRIu64 "; it must be at most %u", number, UINT32_MAX);
}

/* Finds the first required field that is missing, or repeated field that occurs too often. */
static bool fault_in_counts(const struct part *part, const uint32_t counts[MAX_TAG])
{
    pb_field_iter_t field;
    bool more = pb_field_iter_begin_const(&field, part->fields, NULL);
    for (; more; more = pb_field_iter_next(&field)) {
        uint32_t n = counts[field.tag % MAX_TAG];
        if (PB_HTYPE(field.type) == PB_HTYPE_REQUIRED && n == 0)
            return fault_at(part, &field, "is missing");
        if (PB_HTYPE(field.type) == PB_HTYPE_REPEATED && n > field.array_size)
            return fault_at(part, &field, "has %u entries; it may have at most %u", n,
                            (unsigned)field.array_size);
    }
    return false;
}

/* Reads a message to its end. False also if it cannot be read: then there is no field to name. */
static bool find_fault(const struct part *part, pb_istream_t *stream)
{
    uint32_t counts[MAX_TAG] = {0}, tag;
    pb_wire_type_t wire;
    bool end;
    while (pb_decode_tag(stream, &wire, &tag, &end)) {
        pb_field_iter_t field;
        if (pb_field_iter_begin_const(&field, part->fields, NULL) &&
            pb_field_iter_find(&field, tag)) {
            if (fault_in_value(part, &field, wire, stream, &counts[tag % MAX_TAG], &end))
                return true;
            if (end)
                return false;
        } else if (!pb_skip_field(stream, wire)) {
            return false;
        }
    }
    return end && fault_in_counts(part, counts);
}

bool message_find_fault(uint8_t type, const uint8_t *bytes, size_t length,
                        char text[static MESSAGE_TEXT_BYTES])
{
    bool is_hello = type == MESSAGE_HELLO;
    const struct part whole = {is_hello ? sheen_Hello_fields : message_fields(type), "", text};
    size_t prefix = is_hello ? MODEL_ID_BYTES : 0;
    snprintf(text, MESSAGE_TEXT_BYTES, "it is not well-formed");
    if (!whole.fields || length < prefix)
        return false;
    pb_istream_t stream = pb_istream_from_buffer(bytes + prefix, length - prefix);
    return find_fault(&whole, &stream);
}
