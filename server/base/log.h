/* The daemon's log: one event a line on standard error, in logfmt or JSON.
 *
 *     ts=2026-03-01T12:00:00.123Z level=info msg="session closed" session=7 reason=client
 *
 * Values come from outside too: they are cut to LOG_VALUE_BYTES and quoted, so that no value can
 * look like another line or field. Lines above LOG_LINES_PER_S a second are left out and counted,
 * each level by itself and errors excepted, so that no client can fill a disk or hide in a flood;
 * and so are all while a reader of standard error has stopped reading. Thread: any. */
#ifndef SHEEN_BASE_LOG_H
#define SHEEN_BASE_LOG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define LOG_VALUE_BYTES 512 /* of one value, before it is quoted */
#define LOG_LINES_PER_S 200

enum log_level { LOG_ERROR, LOG_WARN, LOG_INFO, LOG_DEBUG };
enum log_format { LOG_LOGFMT, LOG_JSON };

/* A name from us and a value, a text or a number. */
struct log_field {
    const char *key;
    const char *text; /* NULL: the number */
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

/* Lines below `level` are not written. Before the first call: warnings and errors in logfmt. */
void log_set(enum log_level level, enum log_format format);

/* `fields` ends with a row without a key; NULL: none. */
void log_line(enum log_level level, const char *message, const struct log_field *fields);

/* Lines that have been left out since the start. */
uint64_t log_left_out(void);

/* log_event(LOG_INFO, "session closed", log_number("session", 7), log_text("reason", "client")) */
#define log_event(level, message, ...)                                                             \
    log_line(level, message, (const struct log_field[]){__VA_ARGS__, {NULL, NULL, 0}})

#endif
