#include "server/cage/read/numbers/decimal.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* Longer texts are refused: 767 digits decide the worst case of a double. */
#define MAX_LENGTH 1000

/* The number as mantissa * 10^exponent, as far as 64 bits can hold it. */
struct decimal {
    uint64_t mantissa;
    int exponent;
    bool negative;
    bool whole; /* the mantissa holds all digits */
};

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* Appends digits to the mantissa; each reduces the exponent by `shift`. Returns the number of
 * digits. */
static int scan_digits(const char **at, const char *end, struct decimal *decimal, int shift)
{
    const char *p = *at;
    for (; p < end && is_digit(*p); p++) {
        if (decimal->mantissa > (UINT64_MAX - 9) / 10) {
            decimal->whole = false;
            continue;
        }
        decimal->mantissa = decimal->mantissa * 10 + (uint64_t)(*p - '0');
        decimal->exponent -= shift;
    }
    int n = (int)(p - *at);
    *at = p;
    return n;
}

static bool scan_exponent(const char **at, const char *end, struct decimal *decimal)
{
    const char *p = *at;
    bool negative = p < end && *p == '-';
    if (p < end && (*p == '-' || *p == '+'))
        p++;
    if (p == end || !is_digit(*p))
        return false;
    int exponent = 0;
    for (; p < end && is_digit(*p); p++)
        if (exponent < 100000)
            exponent = exponent * 10 + (*p - '0');
    decimal->exponent += negative ? -exponent : exponent;
    *at = p;
    return true;
}

static bool scan(const char *text, const char *end, struct decimal *decimal)
{
    *decimal = (struct decimal){.whole = true};
    const char *p = text;
    if (p < end && (*p == '-' || *p == '+'))
        decimal->negative = *p++ == '-';
    int digits = scan_digits(&p, end, decimal, 0);
    if (p < end && *p == '.') {
        p++;
        digits += scan_digits(&p, end, decimal, 1);
    }
    if (digits == 0)
        return false;
    if (p < end && (*p == 'e' || *p == 'E')) {
        p++;
        if (!scan_exponent(&p, end, decimal))
            return false;
    }
    return p == end;
}

/* The words that printf() writes for NaN and infinity in several C libraries. */
static bool is_not_finite_word(const char *text, size_t length)
{
    static const char *const words[] = {"nan", "inf", "infinity", "1.#inf", "1.#ind", "1.#qnan"};
    if (length > 0 && (*text == '-' || *text == '+')) {
        text++;
        length--;
    }
    if (length > 4 && strncasecmp(text, "nan(", 4) == 0)
        return true;
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (length == strlen(words[i]) && strncasecmp(text, words[i], length) == 0)
            return true;
    return false;
}

enum decimal_result decimal_read(const char *text, size_t length, locale_t c_locale, double *value)
{
    /* Mantissa and power are exact in this case, so the result is rounded once (Clinger 1990). */
    static const double power[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                   1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                   1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    struct decimal decimal;
    if (length > MAX_LENGTH)
        return DECIMAL_BAD;
    if (!scan(text, text + length, &decimal))
        return is_not_finite_word(text, length) ? DECIMAL_NOT_FINITE : DECIMAL_BAD;
    double result;
    if (decimal.whole && decimal.mantissa <= (uint64_t)1 << 53 && abs(decimal.exponent) <= 22) {
        result = (double)decimal.mantissa;
        result = decimal.exponent < 0 ? result / power[-decimal.exponent]
                                      : result * power[decimal.exponent];
        *value = decimal.negative ? -result : result;
        return DECIMAL_OK;
    }
    char copy[MAX_LENGTH + 1];
    memcpy(copy, text, length);
    copy[length] = '\0';
    result = strtod_l(copy, NULL, c_locale);
    if (!isfinite(result))
        return DECIMAL_NOT_FINITE;
    *value = result;
    return DECIMAL_OK;
}
