#include "server/sandbox/stream.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

void sink_init(struct sink *sink, int fd)
{
    sink->fd = fd;
    sink->ok = true;
    sink->used = 0;
}

static void write_out(struct sink *sink, const uint8_t *bytes, size_t size)
{
    while (sink->ok && size > 0) {
        ssize_t n = write(sink->fd, bytes, size);
        if (n > 0) {
            bytes += n;
            size -= (size_t)n;
        } else if (n == 0 || errno != EINTR) {
            sink->ok = false;
        }
    }
}

bool sink_flush(struct sink *sink)
{
    write_out(sink, sink->buffer, sink->used);
    sink->used = 0;
    return sink->ok;
}

void sink_bytes(struct sink *sink, const void *bytes, size_t size)
{
    if (size > sizeof sink->buffer - sink->used)
        sink_flush(sink);
    if (size > sizeof sink->buffer) {
        write_out(sink, bytes, size);
        return;
    }
    if (size > 0)
        memcpy(sink->buffer + sink->used, bytes, size);
    sink->used += size;
}

void sink_u32(struct sink *sink, uint32_t value)
{
    sink_bytes(sink, &value, sizeof value);
}

void sink_u64(struct sink *sink, uint64_t value)
{
    sink_bytes(sink, &value, sizeof value);
}

void sink_text(struct sink *sink, const char *text)
{
    size_t length = text ? strlen(text) : 0;
    sink_u32(sink, (uint32_t)length);
    sink_bytes(sink, length > 0 ? text : "", length + 1);
}

const void *source_bytes(struct source *source, size_t size)
{
    if (!source->ok || size > source->left) {
        source->ok = false;
        return NULL;
    }
    const uint8_t *bytes = source->at;
    source->at += size;
    source->left -= size;
    return bytes;
}

uint32_t source_u32(struct source *source)
{
    uint32_t value = 0;
    const void *bytes = source_bytes(source, sizeof value);
    if (bytes)
        memcpy(&value, bytes, sizeof value);
    return value;
}

uint64_t source_u64(struct source *source)
{
    uint64_t value = 0;
    const void *bytes = source_bytes(source, sizeof value);
    if (bytes)
        memcpy(&value, bytes, sizeof value);
    return value;
}

const char *source_text(struct source *source)
{
    const size_t length = source_u32(source);
    const char *text = source_bytes(source, length + 1);
    if (!text || memchr(text, 0, length + 1) != text + length) {
        source->ok = false;
        return "";
    }
    return text;
}
