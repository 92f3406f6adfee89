#include "server/cage/read/usd/token.h"

#include <stdarg.h>
#include <stdio.h>

bool usd_fail(const struct usd_file *file, uint32_t line, const char *format, ...)
{
    char text[320];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    return error_set(file->error, ERROR_MODEL, "%s:%u: %s", file->name, line, text);
}

/* True if the file goes on with these characters. */
static bool goes_on_with(const struct usd_text *text, const char *characters)
{
    size_t n = strlen(characters);
    return (size_t)(text->file->end - text->at) >= n && memcmp(text->at, characters, n) == 0;
}

/* Steps over one byte, and counts lines: LF, CR LF and CR end one. */
static void step(struct usd_text *text)
{
    char c = *text->at++;
    if (c == '\n' || (c == '\r' && !goes_on_with(text, "\n")))
        text->line++;
}

static void skip_line(struct usd_text *text)
{
    while (text->at < text->file->end && *text->at != '\n' && *text->at != '\r')
        text->at++;
}

/* False: a comment does not end. */
static bool skip_blanks(struct usd_text *text)
{
    while (text->at < text->file->end) {
        char c = *text->at;
        if (c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == ';') {
            step(text);
        } else if (c == '#' || goes_on_with(text, "//")) {
            skip_line(text);
        } else if (goes_on_with(text, "/*")) {
            uint32_t line = text->line;
            text->at += 2;
            while (text->at < text->file->end && !goes_on_with(text, "*/"))
                step(text);
            if (text->at == text->file->end)
                return usd_fail(text->file, line, "the comment that begins here does not end");
            text->at += 2;
        } else {
            break;
        }
    }
    return true;
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* Bytes from 0x80 on are parts of UTF-8 letters. */
static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || (unsigned char)c >= 0x80;
}

static bool is_in_word(char c)
{
    return is_letter(c) || is_digit(c) || c == ':' || c == '.';
}

static bool is_in_number(char c)
{
    return is_letter(c) || is_digit(c) || c == '.' || c == '-' || c == '+';
}

/* Reads from `opening` to `closing`, over several lines if `closing` is three characters. `escape`
 * and the `escaped` bytes after its first one do not end it; NULL: there is no escape. `what` names
 * the token in the message. */
static bool read_quoted(struct usd_text *text, struct usd_token *token, const char *opening,
                        const char *closing, const char *escape, size_t escaped, const char *what)
{
    const char *end = text->file->end;
    bool many_lines = strlen(closing) == 3;
    text->at += strlen(opening);
    token->text = text->at;
    while (text->at < end && !goes_on_with(text, closing)) {
        if (!many_lines && (*text->at == '\n' || *text->at == '\r'))
            break;
        size_t left = escape && goes_on_with(text, escape) ? escaped : 0;
        step(text);
        for (; left > 0 && text->at < end; left--)
            step(text);
    }
    if (!goes_on_with(text, closing))
        return usd_fail(text->file, token->line, "the %s that begins here does not end", what);
    token->length = (size_t)(text->at - token->text);
    text->at += strlen(closing);
    return true;
}

static bool read_string(struct usd_text *text, struct usd_token *token)
{
    char quote = *text->at;
    const char three[] = {quote, quote, quote, 0}, one[] = {quote, 0};
    token->kind = USD_STRING;
    const char *quotes = goes_on_with(text, three) ? three : one;
    return read_quoted(text, token, quotes, quotes, "\\", 1, "string");
}

/* Within "@@@" a backslash keeps "@@@" from ending the name, and one or two further '@' after the
 * end belong to the name. */
static bool read_asset(struct usd_text *text, struct usd_token *token)
{
    token->kind = USD_ASSET;
    if (!goes_on_with(text, "@@@"))
        return read_quoted(text, token, "@", "@", NULL, 0, "name of a file");
    if (!read_quoted(text, token, "@@@", "@@@", "\\@@@", 3, "name of a file"))
        return false;
    for (int i = 0; i < 2 && goes_on_with(text, "@"); i++) {
        text->at++;
        token->length++;
    }
    return true;
}

static void read_run(struct usd_text *text, struct usd_token *token, bool (*is_in)(char))
{
    while (text->at < text->file->end && is_in(*text->at))
        text->at++;
    token->length = (size_t)(text->at - token->text);
}

bool usd_next(struct usd_text *text, struct usd_token *token)
{
    if (!skip_blanks(text))
        return false;
    *token = (struct usd_token){USD_END, text->at, 0, text->line};
    if (text->at == text->file->end)
        return true;
    char c = *text->at;
    if (is_digit(c) || c == '-' || c == '+' || c == '.') {
        token->kind = USD_NUMBER;
        read_run(text, token, is_in_number);
        return true;
    }
    if (is_letter(c)) {
        token->kind = USD_WORD;
        read_run(text, token, is_in_word);
        return true;
    }
    if (c == '"' || c == '\'')
        return read_string(text, token);
    if (c == '@')
        return read_asset(text, token);
    if (c == '<') {
        token->kind = USD_PATH;
        return read_quoted(text, token, "<", ">", NULL, 0, "path");
    }
    if (c != 0 && strchr("()[]{}=,:&", c)) {
        token->kind = USD_SIGN;
        token->length = 1;
        text->at++;
        return true;
    }
    return c > 0x20 && c < 0x7f
               ? usd_fail(text->file, text->line, "'%c' stands where USD has no such character", c)
               : usd_fail(text->file, text->line, "byte 0x%02x is none of a USD text file",
                          (unsigned char)c);
}

bool usd_next_is(struct usd_text *text, char sign, bool *is)
{
    if (!skip_blanks(text))
        return false;
    *is = text->at < text->file->end && *text->at == sign;
    text->at += *is;
    return true;
}

bool usd_expect(struct usd_text *text, char sign, const char *what)
{
    struct usd_token token;
    if (!usd_next(text, &token))
        return false;
    if (usd_is_sign(&token, sign))
        return true;
    if (token.kind == USD_END)
        return usd_fail(text->file, token.line, "the file ends where '%c' must follow %s", sign,
                        what);
    return usd_fail(text->file, token.line, "'%.*s' stands where '%c' must follow %s",
                    USD_SHOWN(&token), sign, what);
}
