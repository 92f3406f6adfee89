/* Parses decimal numbers: correctly rounded, and independent of the locale. Pure, any thread. */
#ifndef SHEEN_CAGE_READ_NUMBERS_DECIMAL_H
#define SHEEN_CAGE_READ_NUMBERS_DECIMAL_H

#include <locale.h>
#include <stddef.h>

enum decimal_result {
    DECIMAL_OK,
    DECIMAL_BAD,        /* not of the form [+-]digits[.digits][e[+-]digits] */
    DECIMAL_NOT_FINITE, /* nan, inf, or too large for a double */
};

/* Parses all `length` bytes of `text`. *value is the nearest double, and is only written for
 * DECIMAL_OK. `c_locale` is a newlocale() of "C". */
enum decimal_result decimal_read(const char *text, size_t length, locale_t c_locale, double *value);

#endif
