/* Tokens that clients may show over TLS, kept as SHA-256 hashes in a file of lines
 *
 *     NAME HASH YYYY-MM-DD        # hash in hex; good until the end of that day, UTC
 *
 * A token is as good as a key: 32 to 255 printable characters from a random source, so that a plain
 * hash cannot be searched. Plain data after reading, no thread. */
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

/* NULL with ERROR_REQUEST that names the file and the line. */
struct tokens *tokens_read(const char *path, struct error *error);
void tokens_destroy(struct tokens *tokens); /* NULL is safe */

struct token {
    char name[TOKEN_NAME_BYTES];
    int64_t expires_s; /* Unix seconds */
    uint8_t hash[TOKEN_HASH_BYTES];
};

/* The token's row, expired or not; NULL when there is none. Takes the same time wherever a token
 * differs from those of the file. */
const struct token *tokens_find(const struct tokens *tokens, const char *text);
/* By name; NULL when it has gone from the file. */
const struct token *tokens_find_name(const struct tokens *tokens, const char *name);

/* The file's line for the token that stands on standard input: `spec` is NAME:YYYY-MM-DD. Prints it
 * on standard output. ERROR_REQUEST when a part is wrong or the token is too short. */
bool tokens_print_line(const char *spec, struct error *error);

#endif
