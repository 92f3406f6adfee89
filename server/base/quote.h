/* Escapes texts from outside for use between quotation marks. Pure, any thread. */
#ifndef SHEEN_BASE_QUOTE_H
#define SHEEN_BASE_QUOTE_H

#include <stddef.h>

enum quote_form {
    /* Control and invisible characters (text.h) as \u001b; also understood by readers of logfmt. */
    QUOTE_JSON,
    QUOTE_METRICS, /* Prometheus' text format: a newline as \n, other such characters as '?' */
};

enum { QUOTE_CHARACTER_BYTES = 16 }; /* enough for one escaped character and a 0 */

/* Escapes the first character of `text`, which must not be empty. Writes the result and a 0 to
 * `escaped` and returns the number of bytes of `text` used. A byte that is not UTF-8 becomes
 * '?'. */
size_t quote_character(enum quote_form form, const char *text,
                       char escaped[static QUOTE_CHARACTER_BYTES]);

#endif
