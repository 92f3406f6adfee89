/* Line families, lights, patterns and false colour as text. The same tables serve for parsing
 * options and for what `sheen lights` and `sheen patterns` print. Pure, any thread. */
#ifndef SHEEN_CLIENT_LIGHTS_TEXT_H
#define SHEEN_CLIENT_LIGHTS_TEXT_H

#include <stdbool.h>
#include <stdint.h>

#include "client/lib/sheen.h"
#include "protocol/ranges.h"

#define LIGHTS_WHY_BYTES 200

/* The parsing functions below return false with one reason in `why`; *value is then undefined. */

/* KIND:key=value,... as `sheen patterns` lists them, or image:FILE. *image_path points to FILE in
 * `text`; NULL for other patterns. */
bool text_pattern(const char *text, struct sheen_pattern *value, const char **image_path,
                  char why[static LIGHTS_WHY_BYTES]);

/* KIND or KIND:one-sided. Sets kind and one_sided only. */
bool text_light(const char *text, struct sheen_light *value, char why[static LIGHTS_WHY_BYTES]);

/* FAMILY or FAMILY:X,Y,Z. Sets family and direction only. */
bool text_lines(const char *text, struct sheen_lines *value, char why[static LIGHTS_WHY_BYTES]);

/* camera, X,Y,Z or dir:X,Y,Z. Sets the eye only. */
bool text_line_eye(const char *text, struct sheen_lines *value, char why[static LIGHTS_WHY_BYTES]);

/* A kind of false colour, or draft:X,Y,Z. Sets kind and direction only. */
bool text_show(const char *text, struct sheen_show *value, char why[static LIGHTS_WHY_BYTES]);

const char *text_pattern_kind(enum sheen_pattern_kind kind);
const char *text_light_kind(enum sheen_light_kind kind);
const char *text_line_family(enum sheen_line_family family);
const char *text_show_kind(enum sheen_show_kind kind);

/* A row of a table of what exists. Tables end with name NULL. */
struct text_row {
    const char *name;
    const char *meaning;
    const char *example; /* options of sheen render; for a part of a pattern: its default */
};
extern const struct text_row TEXT_FAMILIES[], TEXT_LIGHTS[], TEXT_PATTERNS[];
extern const struct text_row TEXT_PATTERN_KEYS[];

/* Writes the row's range, if it is a number of a pattern, and its example. */
#define TEXT_EXAMPLE_BYTES 240
void text_row_example(const struct text_row *row, char text[static TEXT_EXAMPLE_BYTES]);

#endif
