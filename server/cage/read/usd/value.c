#include "server/cage/read/usd/value.h"

#include <math.h>

#include "server/cage/cage.h"
#include "server/cage/read/numbers/decimal.h"

/* The sign that closes a bracket; 0: the sign is no bracket. */
static char closing_of(char sign)
{
    return sign == '(' ? ')' : sign == '[' ? ']' : sign == '{' ? '}' : 0;
}

/* Skips all up to the bracket that closes `opening`, which was read before. */
static bool skip_group(struct usd_text *text, const struct usd_token *opening)
{
    char closing[USD_MAX_DEPTH];
    size_t depth = 1;
    closing[0] = closing_of(*opening->text);
    while (depth > 0) {
        struct usd_token token;
        if (!usd_next(text, &token))
            return false;
        if (token.kind == USD_END)
            return usd_fail(text->file, opening->line, "'%c' is not closed", *opening->text);
        if (token.kind != USD_SIGN)
            continue;
        if (closing_of(*token.text)) {
            if (depth == USD_MAX_DEPTH)
                return usd_fail(text->file, token.line, "values are nested deeper than %d",
                                USD_MAX_DEPTH);
            closing[depth++] = closing_of(*token.text);
        } else if (strchr(")]}", *token.text)) {
            if (*token.text != closing[--depth])
                return usd_fail(text->file, token.line,
                                "'%c' stands where '%c' must close a bracket", *token.text,
                                closing[depth]);
        }
    }
    return true;
}

bool usd_skip_value(struct usd_text *text, bool *is_empty)
{
    struct usd_token token;
    bool is_path, unused;
    if (!is_empty)
        is_empty = &unused;
    if (!usd_next(text, &token))
        return false;
    *is_empty = usd_is_word(&token, "None");
    switch (token.kind) {
    case USD_END:
        return usd_fail(text->file, token.line, "the file ends where a value must follow");
    case USD_ASSET: /* "@file@</Prim>" is one value */
        return usd_next_is(text, '<', &is_path) &&
               (!is_path || (text->at--, usd_next(text, &token)));
    case USD_SIGN:
        if (!closing_of(*token.text))
            return usd_fail(text->file, token.line, "'%c' stands where a value must follow",
                            *token.text);
        if (*token.text != '[')
            return skip_group(text, &token);
        return usd_next_is(text, ']', is_empty) && (*is_empty || skip_group(text, &token));
    default:
        return true;
    }
}

bool usd_skip_metadata(struct usd_text *text)
{
    struct usd_token opening = {USD_SIGN, text->at, 1, text->line};
    bool is;
    if (!usd_next_is(text, '(', &is))
        return false;
    opening.text = text->at - 1;
    opening.line = text->line;
    return !is || skip_group(text, &opening);
}

/* Reads a token that has the form of a number. */
static bool next_number(struct usd_text *text, const char *what, struct usd_token *token)
{
    if (!usd_next(text, token))
        return false;
    if (token->kind == USD_NUMBER || usd_is_word(token, "inf") || usd_is_word(token, "nan"))
        return true;
    if (token->kind == USD_END)
        return usd_fail(text->file, token->line, "the file ends where %s needs a number", what);
    return usd_fail(text->file, token->line, "%s needs a number, not '%.*s'", what,
                    USD_SHOWN(token));
}

static bool is_infinite(const struct usd_token *token)
{
    return usd_text_is(token, "inf") || usd_text_is(token, "+inf");
}

static bool read_decimal(const struct usd_file *file, const struct usd_token *token,
                         const char *what, double *number)
{
    switch (decimal_read(token->text, token->length, file->c_locale, number)) {
    case DECIMAL_OK:
        return true;
    case DECIMAL_BAD:
        return usd_fail(file, token->line, "%s: not a number: '%.*s'", what, USD_SHOWN(token));
    case DECIMAL_NOT_FINITE:
        break;
    }
    return usd_fail(file, token->line, "%s: not a finite number: '%.*s'", what, USD_SHOWN(token));
}

bool usd_number(struct usd_text *text, const char *what, double *number)
{
    struct usd_token token;
    return next_number(text, what, &token) && read_decimal(text->file, &token, what, number);
}

bool usd_sharpness(struct usd_text *text, const char *what, float *sharpness, bool *is_negative)
{
    struct usd_token token;
    double number;
    if (!next_number(text, what, &token))
        return false;
    *sharpness = CAGE_SHARPNESS_INFINITE;
    if (is_infinite(&token))
        return true;
    if (!read_decimal(text->file, &token, what, &number))
        return false;
    if (!isfinite((float)number))
        return usd_fail(text->file, token.line, "%s: too large a number: '%.*s'", what,
                        USD_SHOWN(&token));
    *is_negative |= number < 0;
    *sharpness = number > 0 ? (float)number : 0;
    return true;
}

bool usd_integer(struct usd_text *text, const char *what, int64_t *number)
{
    struct usd_token token;
    if (!next_number(text, what, &token))
        return false;
    const char *at = token.text, *end = at + token.length;
    bool negative = *at == '-';
    at += *at == '-' || *at == '+';
    bool is_good = at < end;
    int64_t value = 0;
    for (; is_good && at < end; at++) {
        is_good = *at >= '0' && *at <= '9';
        if (is_good && value < INT64_C(1000000000000))
            value = value * 10 + (*at - '0');
    }
    if (!is_good)
        return usd_fail(text->file, token.line, "%s needs a whole number, not '%.*s'", what,
                        USD_SHOWN(&token));
    *number = negative ? -value : value;
    return true;
}

/* Reads what follows an element: ',' or the closing sign. *more: another element follows. */
static bool read_separator(struct usd_text *text, char closing, const char *what, bool *more)
{
    bool is_comma, is_closing;
    if (!usd_next_is(text, ',', &is_comma) || !usd_next_is(text, closing, &is_closing))
        return false;
    *more = !is_closing;
    return is_comma || is_closing || usd_expect(text, closing, what);
}

bool usd_tuple(struct usd_text *text, const char *what, size_t n, double *number)
{
    if (!usd_expect(text, '(', what))
        return false;
    bool more = true;
    for (size_t i = 0; i < n; i++) {
        if (!more)
            return usd_fail(text->file, text->line, "%s has %zu number%s, needs %zu", what, i,
                            i == 1 ? "" : "s", n);
        if (!usd_number(text, what, &number[i]) || !read_separator(text, ')', what, &more))
            return false;
    }
    return !more || usd_fail(text->file, text->line, "%s has more than %zu numbers", what, n);
}

bool usd_string(struct usd_text *text, const char *what, struct usd_token *token)
{
    if (!usd_next(text, token))
        return false;
    return token->kind == USD_STRING ||
           usd_fail(text->file, token->line, "%s needs a word in quotes, not '%.*s'", what,
                    USD_SHOWN(token));
}

bool usd_list_begin(struct usd_list *list, const struct usd_text *text, const char *what)
{
    *list = (struct usd_list){.text = *text, .what = what};
    return !text->at || usd_expect(&list->text, '[', what);
}

bool usd_list_next(struct usd_list *list, bool *more)
{
    bool is_end = true;
    if (list->ended || !list->text.at) {
        *more = false;
        return true;
    }
    if (list->begun) {
        if (!read_separator(&list->text, ']', list->what, more))
            return false;
    } else {
        if (!usd_next_is(&list->text, ']', &is_end))
            return false;
        *more = !is_end;
    }
    list->begun = true;
    list->ended = !*more;
    return true;
}
