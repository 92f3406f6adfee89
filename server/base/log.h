/* The daemon's log: one event in each line of standard error, in logfmt or JSON.
 *
 *     ts=2026-03-01T12:00:00.123Z level=info msg="session closed" session=7 reason=client
 *
 * Values may come from outside: they are cut to LOG_VALUE_BYTES and quoted, so that no value can
 * look like another line or field. Lines beyond LOG_LINES_PER_S in a second are dropped and
 * counted, for each level separately and except errors, so that no client can fill a disk or hide
 * in a flood. Lines are also dropped while the reader of standard error does not read.
 * Thread: any. */
#ifndef SHEEN_BASE_LOG_H
#define SHEEN_BASE_LOG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define LOG_VALUE_BYTES 512 /* bytes of one value before quoting */
#define LOG_LINES_PER_S 200

enum log_level { LOG_ERROR, LOG_WARN, LOG_INFO, LOG_DEBUG };
enum log_format { LOG_LOGFMT, LOG_JSON };

/* A field: a key, which is a constant of the program, and a text or a number. */
struct log_field {
    const char *key;
    const char *text; /* NULL: use `number` */
    uint64_t number;
};

static inline struct log_field log_text(const char *key, const char *text)
{
    return (struct log_field){key, text, 0};
}

static inline struct log_field log_number(const char *key, uint64_t number)
{
    return (struct log_field){key, NULL, number};
}

/* Sets the level and the format. Lines less important than `level` are not written. Before the
 * first call: LOG_WARN in logfmt. */
void log_set(enum log_level level, enum log_format format);

/* Writes one line. `fields` ends with an entry whose key is NULL; or NULL: no fields. */
void log_line(enum log_level level, const char *message, const struct log_field *fields);

/* The number of lines dropped since the start. */
uint64_t log_left_out(void);

/* Use: log_event(LOG_INFO, "session closed", log_number("session", 7), log_text("reason",
 * "client")) */
#define log_event(level, message, ...)                                                             \
    log_line(level, message, (const struct log_field[]){__VA_ARGS__, {NULL, NULL, 0}})

#endif
