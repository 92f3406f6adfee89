/* Writes one JSON value: objects and arrays in order, indented by two blanks, strings escaped.
 *
 * `key` is NULL inside arrays and for the outermost value. NaN and infinity become null. The stream
 * belongs to the caller. No function has a name of jansson, which libsheen uses: the linker would
 * take one for the other.
 * Thread: one at a time. */
#ifndef SHEEN_CLIENT_JSON_H
#define SHEEN_CLIENT_JSON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

struct json {
    FILE *out;
    int depth;
    bool needs_comma; /* this object or array has an element already */
};

void json_object_begin(struct json *json, const char *key);
void json_object_end(struct json *json);
void json_array_begin(struct json *json, const char *key);
void json_array_end(struct json *json);
void json_text(struct json *json, const char *key, const char *value);
void json_uint(struct json *json, const char *key, uint64_t value);
/* In the fewest digits that give the same number back. */
void json_double(struct json *json, const char *key, double value);
/* Writes the number alone, finite, with the fewest digits that read back equal: for files of other
 * formats. */
void json_write_double(FILE *out, double value);
void json_bool(struct json *json, const char *key, bool value);
void json_vec3(struct json *json, const char *key, const double value[static 3]);
void json_hex(struct json *json, const char *key, const uint8_t *bytes, size_t n_bytes);
/* Writes lines separated by '\n' as an array of strings. */
void json_lines(struct json *json, const char *key, const char *lines);
/* Ends the text with a newline and flushes. False if the stream had an error. */
bool json_finish(struct json *json);

#endif
