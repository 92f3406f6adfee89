/* Line families, lights, patterns and false colour as text: what the options take, and what
 * `sheen lights` and `sheen patterns` say of the first three, from the same tables. */
#ifndef SHEEN_CLIENT_LIGHTS_TEXT_H
#define SHEEN_CLIENT_LIGHTS_TEXT_H

#include <stdbool.h>
#include <stdint.h>

#include "client/lib/sheen.h"
#include "protocol/ranges.h"

#define LIGHTS_WHY_BYTES 200

/* The functions below return false with one reason in `why`; *value is then undefined. */

/* KIND:key=value,... as `sheen patterns` lists them, or image:FILE, for which *image_path then
 * points into `text`, else NULL. */
bool text_pattern(const char *text, struct sheen_pattern *value, const char **image_path,
                  char why[static LIGHTS_WHY_BYTES]);

/* KIND or KIND:one-sided; only these two members are set. */
bool text_light(const char *text, struct sheen_light *value, char why[static LIGHTS_WHY_BYTES]);

/* FAMILY or FAMILY:X,Y,Z; family and direction are set. */
bool text_lines(const char *text, struct sheen_lines *value, char why[static LIGHTS_WHY_BYTES]);

/* camera, X,Y,Z or dir:X,Y,Z; the eye is set. */
bool text_line_eye(const char *text, struct sheen_lines *value, char why[static LIGHTS_WHY_BYTES]);

/* A kind of false colour, or draft:X,Y,Z; kind and direction are set. */
bool text_show(const char *text, struct sheen_show *value, char why[static LIGHTS_WHY_BYTES]);

const char *text_pattern_kind(enum sheen_pattern_kind kind);
const char *text_light_kind(enum sheen_light_kind kind);
const char *text_line_family(enum sheen_line_family family);
const char *text_show_kind(enum sheen_show_kind kind);

/* One line of what there is. Tables end with name NULL. */
struct text_row {
    const char *name;
    const char *meaning;
    const char *example; /* options of sheen render; of a part: its default */
};
extern const struct text_row TEXT_FAMILIES[], TEXT_LIGHTS[], TEXT_PATTERNS[];
extern const struct text_row TEXT_PATTERN_KEYS[];

/* The range, where it is the part of a pattern that is a number, and the example. */
#define TEXT_EXAMPLE_BYTES 240
void text_row_example(const struct text_row *row, char text[static TEXT_EXAMPLE_BYTES]);

#endif
