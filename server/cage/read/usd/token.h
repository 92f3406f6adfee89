/* Splits USD's text form ("usda") into tokens. Internal to the USD reader.
 *
 * Blanks, line endings, ';' and comments (from '#' or "//" to the end of the line, and between
 * slash-star and star-slash) separate tokens. Tokens point into the file: nothing is copied. Any
 * thread. */
#ifndef SHEEN_CAGE_READ_USD_TOKEN_H
#define SHEEN_CAGE_READ_USD_TOKEN_H

#include <locale.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "server/base/error.h"

/* What all parts of the reader need to know of the file. */
struct usd_file {
    const char *name; /* for messages; owned by the caller */
    const char *end;
    locale_t c_locale;
    struct error *error;
};

/* A place in the file. */
struct usd_text {
    const struct usd_file *file;
    const char *at;
    uint32_t line; /* of `at`, from 1 */
};

enum usd_token_kind {
    USD_END,    /* the end of the file */
    USD_WORD,   /* letters, digits, '_', ':' and '.', such as def, point3f or points.timeSamples */
    USD_NUMBER, /* begins with a digit, '-', '+' or '.'; not checked further */
    USD_STRING, /* within one or three ' or " */
    USD_ASSET,  /* within one or three @ */
    USD_PATH,   /* within < > */
    USD_SIGN,   /* one of ( ) [ ] { } = , : & */
};

struct usd_token {
    enum usd_token_kind kind;
    const char *text; /* without the quotes; escapes are left as they are */
    size_t length;
    uint32_t line; /* where the token begins */
};

/* Reads the next token. False with ERROR_MODEL at a byte that begins no token, and at a string that
 * does not end. At the end of the file every call gives USD_END. */
bool usd_next(struct usd_text *text, struct usd_token *token);

/* Reads the next token if it is `sign`, and then sets *is to true. Otherwise sets *is to false and
 * skips only blanks. False as usd_next(). */
bool usd_next_is(struct usd_text *text, char sign, bool *is);

/* Reads a sign that must follow; `what` says after what, for the message. */
bool usd_expect(struct usd_text *text, char sign, const char *what);

/* Sets the error "NAME:LINE: " and the text. Returns false. */
bool usd_fail(const struct usd_file *file, uint32_t line, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* The arguments of "%.*s" to show a text in a message, cut to 40 bytes. */
#define USD_SHOWN(shown) (int)((shown)->length < 40 ? (shown)->length : 40), (shown)->text

static inline bool usd_is_sign(const struct usd_token *token, char sign)
{
    return token->kind == USD_SIGN && *token->text == sign;
}

/* True if the token, of any kind, has this text. */
static inline bool usd_text_is(const struct usd_token *token, const char *text)
{
    return token->length == strlen(text) && memcmp(token->text, text, token->length) == 0;
}

static inline bool usd_is_word(const struct usd_token *token, const char *word)
{
    return token->kind == USD_WORD && usd_text_is(token, word);
}

#endif
