#include "client/cli/output/json.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/text.h"

/* File names may hold any bytes: bytes that are not UTF-8 become U+FFFD, so that the text stays
 * valid JSON. */
static void write_string(FILE *out, const char *value, size_t length)
{
    fputc('"', out);
    for (size_t i = 0; i < length;) {
        unsigned char c = (unsigned char)value[i];
        size_t n = text_utf8_length(value + i);
        if (n == 0)
            fputs("\\ufffd", out);
        else if (c == '"' || c == '\\')
            fprintf(out, "\\%c", c);
        else if (c < 0x20 || c == 0x7f)
            fprintf(out, "\\u%04x", c);
        else
            fwrite(value + i, 1, n, out);
        i += n ? n : 1;
    }
    fputc('"', out);
}

/* Writes the comma, new line, indent and key in front of a value. */
static void begin_value(struct json *json, const char *key)
{
    if (json->needs_comma)
        fputc(',', json->out);
    if (json->depth > 0)
        fprintf(json->out, "\n%*s", 2 * json->depth, "");
    if (key) {
        write_string(json->out, key, strlen(key));
        fputs(": ", json->out);
    }
    json->needs_comma = true;
}

static void begin_group(struct json *json, const char *key, char bracket)
{
    begin_value(json, key);
    fputc(bracket, json->out);
    json->depth++;
    json->needs_comma = false;
}

static void end_group(struct json *json, char bracket)
{
    json->depth--;
    if (json->needs_comma)
        fprintf(json->out, "\n%*s", 2 * json->depth, "");
    fputc(bracket, json->out);
    json->needs_comma = true;
}

void json_object_begin(struct json *json, const char *key)
{
    begin_group(json, key, '{');
}

void json_object_end(struct json *json)
{
    end_group(json, '}');
}

void json_array_begin(struct json *json, const char *key)
{
    begin_group(json, key, '[');
}

void json_array_end(struct json *json)
{
    end_group(json, ']');
}

void json_text(struct json *json, const char *key, const char *value)
{
    begin_value(json, key);
    write_string(json->out, value, strlen(value));
}

void json_uint(struct json *json, const char *key, uint64_t value)
{
    begin_value(json, key);
    fprintf(json->out, "%" PRIu64, value);
}

/* Writes the fewest digits that give the same number back. */
void json_write_double(FILE *out, double value)
{
    char text[32];
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, sizeof(text), "%.*g", digits, value);
        if (strtod(text, NULL) == value)
            break;
    }
    fputs(text, out);
}

void json_double(struct json *json, const char *key, double value)
{
    begin_value(json, key);
    if (isfinite(value))
        json_write_double(json->out, value);
    else
        fputs("null", json->out);
}

void json_bool(struct json *json, const char *key, bool value)
{
    begin_value(json, key);
    fputs(value ? "true" : "false", json->out);
}

void json_vec3(struct json *json, const char *key, const double value[static 3])
{
    json_array_begin(json, key);
    for (int i = 0; i < 3; i++)
        json_double(json, NULL, value[i]);
    json_array_end(json);
}

void json_hex(struct json *json, const char *key, const uint8_t *bytes, size_t n_bytes)
{
    begin_value(json, key);
    fputc('"', json->out);
    for (size_t i = 0; i < n_bytes; i++)
        fprintf(json->out, "%02x", bytes[i]);
    fputc('"', json->out);
}

void json_lines(struct json *json, const char *key, const char *lines)
{
    json_array_begin(json, key);
    while (*lines) {
        size_t length = strcspn(lines, "\n");
        if (length > 0) {
            begin_value(json, NULL);
            write_string(json->out, lines, length);
        }
        lines += length + (lines[length] == '\n');
    }
    json_array_end(json);
}

bool json_finish(struct json *json)
{
    fputc('\n', json->out);
    return fflush(json->out) == 0 && !ferror(json->out);
}
