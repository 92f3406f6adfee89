#include "server/cage/read/words.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "server/cage/read/numbers/decimal.h"

/* The arguments of "%.*s" to show a word in a message, cut to 40 bytes. */
#define SHOWN(word) (int)((word)->length < 40 ? (word)->length : 40), (word)->text

bool words_init(struct words *words, const void *bytes, size_t size, const char *name,
                const char *kind, struct error *error)
{
    const char *text = bytes, *zero = memchr(bytes, 0, size);
    *words = (struct words){
        .text = {.at = text, .end = text + size, .line = 1}, .name = name, .error = error};
    if (zero)
        return error_set(
            error, ERROR_MODEL,
            "%s: is not a %s file: byte %zu is 0, so the file is damaged, UTF-16 or of "
            "another kind",
            name, kind, (size_t)(zero - text));
    if (size >= 3 && memcmp(bytes, "\xef\xbb\xbf", 3) == 0)
        words->text.at += 3; /* a byte order mark */
    words->c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    return words->c_locale ||
           error_set(error, ERROR_SERVER, "%s: not enough memory to read it", name);
}

void words_finish(struct words *words)
{
    if (words->c_locale)
        freelocale(words->c_locale);
}

bool words_next(struct words *words, struct obj_field *word)
{
    bool found;
    while (!(found = obj_text_field(&words->text, word)) && words->text.at < words->text.end)
        obj_text_next_line(&words->text);
    words->line = words->text.line;
    return found;
}

bool words_fail(const struct words *words, const char *format, ...)
{
    char text[320];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    return error_set(words->error, ERROR_MODEL, "%s:%u: %s", words->name, words->line, text);
}

bool words_number(struct words *words, double *value, const char *what)
{
    struct obj_field word;
    if (!words_next(words, &word))
        return words_fail(words, "the file ends before %s", what);
    switch (decimal_read(word.text, word.length, words->c_locale, value)) {
    case DECIMAL_OK:
        break;
    case DECIMAL_BAD:
        return words_fail(words, "%s is not a number: '%.*s'", what, SHOWN(&word));
    case DECIMAL_NOT_FINITE:
        return words_fail(words, "%s is not finite: '%.*s'", what, SHOWN(&word));
    }
    if (fabs(*value) > CAGE_MAX_COORDINATE)
        return words_fail(words, "%s is %g, beyond the largest that is read, %g", what, *value,
                          CAGE_MAX_COORDINATE);
    return true;
}

bool words_count(struct words *words, uint32_t low, uint32_t high, uint32_t *value,
                 const char *what)
{
    double number;
    if (!words_number(words, &number, what))
        return false;
    if (!(number >= low && number <= high) || number != floor(number))
        return words_fail(words, "%s is %.9g, needs a whole number from %u to %u", what, number,
                          low, high);
    *value = (uint32_t)number;
    return true;
}

bool words_points(struct words *words, double (*points)[3], size_t n, const char *what)
{
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < 3; k++) {
            char coordinate[80];
            snprintf(coordinate, sizeof coordinate, "coordinate %c of %s %zu", "xyz"[k], what,
                     i + 1);
            if (!words_number(words, &points[i][k], coordinate))
                return false;
        }
    return true;
}
