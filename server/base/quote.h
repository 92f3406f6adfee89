/* Texts from outside, escaped to stand between quotation marks. Pure, any thread. */
#ifndef SHEEN_BASE_QUOTE_H
#define SHEEN_BASE_QUOTE_H

#include <stddef.h>

enum quote_form {
    QUOTE_JSON, /* control and unseen characters (text.h) as \u001b; logfmt's readers take the same */
    QUOTE_METRICS, /* Prometheus' text format: a newline as \n, other such characters as '?' */
};

enum { QUOTE_CHARACTER_BYTES = 16 }; /* of one escaped character, with its 0 */

/* Writes the first character of `text`, which is not empty, escaped and with a 0, and returns how
 * many bytes of `text` it took. A byte that is not UTF-8 becomes '?'. */
size_t quote_character(enum quote_form form, const char *text,
                       char escaped[static QUOTE_CHARACTER_BYTES]);

#endif
