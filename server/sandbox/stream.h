/* Plain values one after another: written to a file in memory by one process, read out of its
 * mapping by another on the same machine. Numbers are in the machine's own byte order, unaligned.
 *
 * A sink and a source remember their first failure, so that many values may be moved with one check
 * at the end. Thread: each belongs to one at a time. */
#ifndef SHEEN_SANDBOX_STREAM_H
#define SHEEN_SANDBOX_STREAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define SINK_BUFFER_BYTES 16384

struct sink {
    int fd;  /* not owned */
    bool ok; /* false: a write failed, errno says why; nothing is written any more */
    size_t used;
    uint8_t buffer[SINK_BUFFER_BYTES];
};

void sink_init(struct sink *sink, int fd);
void sink_bytes(struct sink *sink, const void *bytes, size_t size);
void sink_u32(struct sink *sink, uint32_t value);
void sink_u64(struct sink *sink, uint64_t value);
/* A length, the text and its end; NULL is as "". */
void sink_text(struct sink *sink, const char *text);
/* Writes out what is buffered; returns sink->ok. */
bool sink_flush(struct sink *sink);

/* Bytes that a process that may be hostile has written: nothing about them is trusted. */
struct source {
    const uint8_t *at;
    size_t left;
    bool ok; /* false: more was asked for than there is, or a text was no text */
};

/* The next `size` bytes, or NULL, when there are not so many. */
const void *source_bytes(struct source *source, size_t size);
uint32_t source_u32(struct source *source); /* 0 on failure */
uint64_t source_u64(struct source *source); /* 0 on failure */
/* A text with its end, where it lies; "" on failure, as when there is another end before. */
const char *source_text(struct source *source);

#endif
