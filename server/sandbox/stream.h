/* A stream of plain values: one process writes them to a file in memory through a sink, and another
 * process on the same machine reads them from the file's mapping through a source. Numbers are in
 * native byte order, unaligned.
 *
 * A sink and a source remember their first failure, so that the caller can check once at the end.
 * Thread: each is used by one at a time. */
#ifndef SHEEN_SANDBOX_STREAM_H
#define SHEEN_SANDBOX_STREAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define SINK_BUFFER_BYTES 16384

struct sink {
    int fd;  /* not owned */
    bool ok; /* false: a write failed, with errno; nothing more is written */
    size_t used;
    uint8_t buffer[SINK_BUFFER_BYTES];
};

void sink_init(struct sink *sink, int fd);
void sink_bytes(struct sink *sink, const void *bytes, size_t size);
void sink_u32(struct sink *sink, uint32_t value);
void sink_u64(struct sink *sink, uint64_t value);
/* Writes a length, the text and a 0. NULL is written as "". */
void sink_text(struct sink *sink, const char *text);
/* Writes the buffered bytes to the file. Returns sink->ok. */
bool sink_flush(struct sink *sink);

/* Reads bytes that a possibly hostile process has written: nothing about them is trusted. */
struct source {
    const uint8_t *at;
    size_t left;
    bool ok; /* false: there were fewer bytes than asked for, or a text was malformed */
};

/* Returns the next `size` bytes, which stay where they are; NULL if there are fewer. */
const void *source_bytes(struct source *source, size_t size);
uint32_t source_u32(struct source *source); /* 0 on failure */
uint64_t source_u64(struct source *source); /* 0 on failure */
/* Returns a text that ends with 0 and stays where it is. Returns "" on failure, for example if the
 * text has a 0 before its end. */
const char *source_text(struct source *source);

#endif
