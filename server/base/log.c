#include "server/base/log.h"

#include <inttypes.h>
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/base/quote.h"

#define LINE_BYTES 16384 /* enough for five values that consist of escapes */

static struct {
    enum log_level level;
    enum log_format format;
    uint64_t second_us;            /* when the current second began */
    unsigned lines[LOG_DEBUG + 1]; /* lines written in that second, by level */
    uint64_t left_out, unreported; /* lines dropped: in all, and since that was last reported */
} state = {.level = LOG_WARN};
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER; /* protects `state` */

struct line {
    char text[LINE_BYTES];
    size_t used;
};

static void put(struct line *line, const char *text, size_t n)
{
    if (n > sizeof line->text - 1 - line->used) /* keep one byte for the newline */
        n = sizeof line->text - 1 - line->used;
    memcpy(line->text + line->used, text, n);
    line->used += n;
}

static void put_text(struct line *line, const char *text)
{
    put(line, text, strlen(text));
}

/* Writes a text in quotation marks, escaped as in JSON; logfmt understands the same escapes. */
static void put_quoted(struct line *line, const char *text)
{
    put_text(line, "\"");
    for (const char *c = text; *c && c - text < LOG_VALUE_BYTES;) {
        char escaped[QUOTE_CHARACTER_BYTES];
        c += quote_character(QUOTE_JSON, c, escaped);
        put_text(line, escaped);
    }
    put_text(line, "\"");
}

/* True if logfmt needs no quotation marks for this text. */
static bool is_bare(const char *text)
{
    if (!*text)
        return false;
    for (const char *c = text; *c; c++)
        if (!strchr("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.:/,+@[]%",
                    *c))
            return false;
    return strlen(text) < LOG_VALUE_BYTES;
}

static void put_key(struct line *line, const char *key)
{
    bool first = line->used == 0;
    if (state.format == LOG_JSON) {
        put_text(line, first ? "{\"" : ",\"");
        put_text(line, key);
        put_text(line, "\":");
    } else {
        put_text(line, first ? "" : " ");
        put_text(line, key);
        put_text(line, "=");
    }
}

static void put_field(struct line *line, const struct log_field *field)
{
    char number[24];
    put_key(line, field->key);
    if (!field->text) {
        snprintf(number, sizeof number, "%" PRIu64, field->number);
        put_text(line, number);
    } else if (state.format == LOG_LOGFMT && is_bare(field->text)) {
        put_text(line, field->text);
    } else {
        put_quoted(line, field->text);
    }
}

static bool write_line(enum log_level level, const char *message, const struct log_field *fields)
{
    static const char *const LEVELS[] = {"error", "warn", "info", "debug"};
    struct line line = {.used = 0};
    struct timespec now;
    struct tm utc;
    char date[32], stamp[56];
    clock_gettime(CLOCK_REALTIME, &now);
    gmtime_r(&now.tv_sec, &utc);
    strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%S", &utc);
    snprintf(stamp, sizeof stamp, "%s.%03ldZ", date, now.tv_nsec / 1000000);
    put_field(&line, &(struct log_field){"ts", stamp, 0});
    put_field(&line, &(struct log_field){"level", LEVELS[level], 0});
    put_field(&line, &(struct log_field){"msg", message, 0});
    for (; fields && fields->key; fields++)
        put_field(&line, fields);
    if (state.format == LOG_JSON)
        put_text(&line, "}");
    line.text[line.used++] = '\n';
    /* Write each line by one call, so that lines of several processes do not mix. Write nothing
     * while a pipe is full, because the daemon would block. A failure cannot be reported
     * anywhere. */
    struct pollfd reader = {.fd = STDERR_FILENO, .events = POLLOUT};
    return poll(&reader, 1, 0) != 0 && write(STDERR_FILENO, line.text, line.used) > 0;
}

static bool is_too_much(enum log_level level)
{
    uint64_t now = clock_now_us();
    if (now - state.second_us >= 1000000) {
        state.second_us = now;
        memset(state.lines, 0, sizeof state.lines);
        if (state.unreported &&
            write_line(
                LOG_WARN, "log lines were left out",
                (const struct log_field[]){log_number("count", state.unreported), {NULL, NULL, 0}}))
            state.unreported = 0;
    }
    return ++state.lines[level] > LOG_LINES_PER_S && level != LOG_ERROR;
}

void log_set(enum log_level level, enum log_format format)
{
    pthread_mutex_lock(&lock);
    state.level = level;
    state.format = format;
    pthread_mutex_unlock(&lock);
}

void log_line(enum log_level level, const char *message, const struct log_field *fields)
{
    pthread_mutex_lock(&lock);
    if (level <= state.level && (is_too_much(level) || !write_line(level, message, fields))) {
        state.left_out++;
        state.unreported++;
    }
    pthread_mutex_unlock(&lock);
}

uint64_t log_left_out(void)
{
    pthread_mutex_lock(&lock);
    uint64_t n = state.left_out;
    pthread_mutex_unlock(&lock);
    return n;
}
