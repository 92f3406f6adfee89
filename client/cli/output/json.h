/* A writer of one JSON value: objects and arrays in order, two-space indent, strings escaped.
 *
 * `key` is NULL inside arrays and for the outermost value. Numbers that JSON does not have (NaN,
 * infinity) become null. The stream is the caller's. Thread: one writer belongs to one thread. */
#ifndef SHEEN_CLIENT_JSON_H
#define SHEEN_CLIENT_JSON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

struct json {
    FILE *out;
    int depth;
    bool needs_comma; /* something stands before in this object or array */
};

void json_object_begin(struct json *json, const char *key);
void json_object_end(struct json *json);
void json_array_begin(struct json *json, const char *key);
void json_array_end(struct json *json);
void json_string(struct json *json, const char *key, const char *value);
void json_uint(struct json *json, const char *key, uint64_t value);
void json_double(struct json *json, const char *key, double value); /* reads back exactly */
void json_bool(struct json *json, const char *key, bool value);
void json_vec3(struct json *json, const char *key, const double value[static 3]);
void json_hex(struct json *json, const char *key, const uint8_t *bytes, size_t n_bytes);
/* Lines joined by '\n' as an array of strings. */
void json_lines(struct json *json, const char *key, const char *lines);
/* Ends the text with a newline and flushes. False when the stream took an error. */
bool json_finish(struct json *json);

#endif
