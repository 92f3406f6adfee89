#include "server/net/tokens.h"

#include <errno.h>
#include <openssl/crypto.h>
#include <openssl/sha.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "server/base/hex.h"
#include "server/base/plain_file.h"

_Static_assert(TOKEN_HASH_BYTES == SHA256_DIGEST_LENGTH, "a hash is a SHA-256");
#define LINE_BYTES 256

struct tokens {
    size_t n;
    struct token rows[TOKENS_MAX];
};

/* --- parts of a line */

static bool is_name(const char *text)
{
    size_t n = strspn(text, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-");
    return n > 0 && text[n] == 0 && n < TOKEN_NAME_BYTES;
}

/* The end of the day YYYY-MM-DD in Unix seconds. */
static bool parse_day(const char *text, int64_t *end_s)
{
    struct tm day = {0};
    const char *end = strptime(text, "%Y-%m-%d", &day);
    if (!end || *end || strlen(text) != 10)
        return false;
    int month_day = day.tm_mday;
    *end_s = (int64_t)timegm(&day) + 86400;
    return day.tm_mday == month_day; /* false for 31 April, which timegm() makes 1 May */
}

/* --- reading */

/* Adds the row of a line; a line with only a comment adds none. Returns NULL, or what is wrong. */
static const char *add_line(struct tokens *tokens, char *line)
{
    char *rest = line, *name, *hash, *day;
    line[strcspn(line, "#\r\n")] = 0;
    if (!(name = strtok_r(line, " \t", &rest)))
        return NULL;
    hash = strtok_r(NULL, " \t", &rest);
    day = hash ? strtok_r(NULL, " \t", &rest) : NULL;
    if (!day || strtok_r(NULL, " \t", &rest))
        return "a line is 'NAME HASH YYYY-MM-DD'; sheend --hash-token writes it";
    if (tokens->n == TOKENS_MAX)
        return "there are too many tokens: at most 1024";
    struct token *row = &tokens->rows[tokens->n];
    if (!is_name(name))
        return "a name is 1 to 64 of the characters A-Z a-z 0-9 . _ -";
    if (tokens_find_name(tokens, name))
        return "this name stands above already";
    if (!hex_read(hash, row->hash, sizeof row->hash))
        return "the hash is not 64 digits of lower-case hex";
    if (!parse_day(day, &row->expires_s))
        return "the last part is no day, written YYYY-MM-DD";
    snprintf(row->name, sizeof row->name, "%s", name);
    tokens->n++;
    return NULL;
}

static bool read_lines(struct tokens *tokens, FILE *file, const char *path, struct error *error)
{
    char line[LINE_BYTES];
    for (unsigned number = 1; fgets(line, sizeof line, file); number++) {
        const char *wrong = strlen(line) == sizeof line - 1 && line[sizeof line - 2] != '\n'
                                ? "the line is too long"
                                : add_line(tokens, line);
        if (wrong)
            return error_set(error, ERROR_REQUEST, "%s:%u: %s", path, number, wrong);
    }
    return !ferror(file) || error_set(error, ERROR_REQUEST, "cannot read %s", path);
}

struct tokens *tokens_read(const char *path, struct error *error)
{
    if (!plain_file_check(path, error))
        return NULL;
    FILE *file = fopen(path, "re");
    if (!file) {
        error_set(error, ERROR_REQUEST, "cannot read %s: %s", path, strerror(errno));
        return NULL;
    }
    struct tokens *tokens = calloc(1, sizeof *tokens);
    if (!tokens)
        error_set(error, ERROR_SERVER, "no memory for the tokens");
    if (!tokens || !read_lines(tokens, file, path, error)) {
        tokens_destroy(tokens);
        tokens = NULL;
    }
    fclose(file);
    return tokens;
}

void tokens_destroy(struct tokens *tokens)
{
    free(tokens);
}

const struct token *tokens_find(const struct tokens *tokens, const char *text)
{
    const struct token *found = NULL;
    uint8_t hash[TOKEN_HASH_BYTES];
    SHA256((const unsigned char *)text, strlen(text), hash);
    for (size_t i = 0; i < tokens->n; i++)
        if (CRYPTO_memcmp(hash, tokens->rows[i].hash, sizeof hash) == 0)
            found = &tokens->rows[i];
    return found;
}

const struct token *tokens_find_name(const struct tokens *tokens, const char *name)
{
    for (size_t i = 0; i < tokens->n; i++)
        if (strcmp(tokens->rows[i].name, name) == 0)
            return &tokens->rows[i];
    return NULL;
}

/* --- writing */

static bool read_token(char token[static TOKEN_MAX_BYTES + 2], struct error *error)
{
    if (!fgets(token, TOKEN_MAX_BYTES + 2, stdin))
        token[0] = 0;
    token[strcspn(token, "\r\n")] = 0;
    size_t length = strlen(token), printable = 0;
    while (token[printable] > ' ' && token[printable] <= '~')
        printable++;
    return (length >= TOKEN_MIN_BYTES && length <= TOKEN_MAX_BYTES && printable == length) ||
           error_set(error, ERROR_REQUEST,
                     "the token on standard input must be one line of %u to %u printable "
                     "characters without spaces, from a random source: openssl rand -base64 32",
                     TOKEN_MIN_BYTES, TOKEN_MAX_BYTES);
}

bool tokens_print_line(const char *spec, struct error *error)
{
    char name[TOKEN_NAME_BYTES] = "", token[TOKEN_MAX_BYTES + 2], hex[2 * TOKEN_HASH_BYTES + 1];
    uint8_t hash[TOKEN_HASH_BYTES];
    int64_t end_s;
    size_t length = strcspn(spec, ":");
    if (length < sizeof name)
        snprintf(name, sizeof name, "%.*s", (int)length, spec);
    if (!is_name(name) || spec[length] != ':' || !parse_day(spec + length + 1, &end_s))
        return error_set(error, ERROR_REQUEST,
                         "hash-token is '%s'; it must be NAME:YYYY-MM-DD, a name of 1 to 64 of the "
                         "characters A-Z a-z 0-9 . _ - and the last day",
                         spec);
    if (!read_token(token, error))
        return false;
    SHA256((const unsigned char *)token, strlen(token), hash);
    OPENSSL_cleanse(token, sizeof token);
    hex_write(hash, sizeof hash, hex);
    printf("%s %s %s\n", name, hex, spec + length + 1);
    return true;
}
