/* Reads the values of USD's properties: numbers, tuples, arrays and words. Internal to the USD
 * reader.
 *
 * A value is kept as the place where it begins, and its numbers are read when a mesh needs them: no
 * array is copied. The functions return false with ERROR_MODEL, which names the line, where the
 * text is not what they read. `what` names the value in the message. Any thread. */
#ifndef SHEEN_CAGE_READ_USD_VALUE_H
#define SHEEN_CAGE_READ_USD_VALUE_H

#include "server/cage/read/usd/token.h"

/* Values and prims that are nested deeper than this are refused. */
#define USD_MAX_DEPTH 128

/* Skips one value of any type: an atom, or all between brackets. *is_empty, if not NULL: the value
 * is None or []. */
bool usd_skip_value(struct usd_text *text, bool *is_empty);

/* Skips "( ... )", if it follows. */
bool usd_skip_metadata(struct usd_text *text);

/* A finite number. */
bool usd_number(struct usd_text *text, const char *what, double *number);

/* Reads a sharpness. Infinity becomes CAGE_SHARPNESS_INFINITE. A negative number becomes 0 and sets
 * *is_negative; otherwise *is_negative is unchanged. */
bool usd_sharpness(struct usd_text *text, const char *what, float *sharpness, bool *is_negative);

/* Reads a whole number. Beyond 10^12 in magnitude the value is not exact, but its magnitude is at
 * least 10^12. */
bool usd_integer(struct usd_text *text, const char *what, int64_t *number);

/* n finite numbers in parentheses. */
bool usd_tuple(struct usd_text *text, const char *what, size_t n, double *number);

/* A string; token->text points into the file. */
bool usd_string(struct usd_text *text, const char *what, struct usd_token *token);

/* A walk through an array, element by element: usd_list_begin() once, then usd_list_next() before
 * each element, which the caller reads from list.text. */
struct usd_list {
    struct usd_text text;
    const char *what;
    bool begun, ended;
};

/* Begins at the array's '['. `text` is a copy of the place; a place with `at` NULL is an array
 * without elements. */
bool usd_list_begin(struct usd_list *list, const struct usd_text *text, const char *what);
/* *more: an element follows. After the last element every call gives false. */
bool usd_list_next(struct usd_list *list, bool *more);

#endif
