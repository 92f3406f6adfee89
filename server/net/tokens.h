/* The tokens by which TLS clients identify themselves. A file holds their SHA-256 hashes, one in a
 * line:
 *
 *     NAME HASH YYYY-MM-DD        # hash in hex; valid until the end of that day, UTC
 *
 * A token is as strong as a key: 32 to 255 printable characters from a random source. That is why a
 * plain hash is enough: it cannot be found by search. Plain data after reading; any thread. */
#ifndef SHEEN_NET_TOKENS_H
#define SHEEN_NET_TOKENS_H

#include <stdint.h>

#include "server/base/error.h"

#define TOKENS_MAX 1024
#define TOKEN_NAME_BYTES 65
#define TOKEN_HASH_BYTES 32
#define TOKEN_MIN_BYTES 32u
#define TOKEN_MAX_BYTES 255u

struct tokens;

/* Reads the file. NULL with ERROR_REQUEST, which names the file and the line. */
struct tokens *tokens_read(const char *path, struct error *error);
void tokens_destroy(struct tokens *tokens); /* NULL is safe */

struct token {
    char name[TOKEN_NAME_BYTES];
    int64_t expires_s; /* Unix seconds */
    uint8_t hash[TOKEN_HASH_BYTES];
};

/* Finds the row of the token `text`, expired or not; NULL if there is none. The time that it takes
 * does not depend on where a token differs from those in the file. */
const struct token *tokens_find(const struct tokens *tokens, const char *text);
/* Finds a token by name; NULL if the file does not have it. */
const struct token *tokens_find_name(const struct tokens *tokens, const char *name);

/* Reads a token from standard input and prints its line for the file on standard output; `spec` is
 * NAME:YYYY-MM-DD. False with ERROR_REQUEST if `spec` is malformed or the token is too short. */
bool tokens_print_line(const char *spec, struct error *error);

#endif
