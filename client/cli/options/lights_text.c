#include "client/cli/options/lights_text.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "client/cli/options/values.h"

const struct text_row TEXT_FAMILIES[] = {
    {"reflection", "where the view ray, mirrored at the surface, meets the light",
     "--lines reflection"},
    {"highlight", "where the surface's normal meets the light, whatever the view",
     "--lines highlight"},
    {"isophote", "the angle between the normal and X,Y,Z (default: the direction to the eye)",
     "--lines isophote:0,0,1 --pattern stripes:count=36"},
    {"zebra", "the elevation of the mirrored ray, for the axis X,Y,Z (default: --up)",
     "--lines zebra --pattern stripes:count=30"},
    {"environment",
     "the place of the mirrored ray on a sphere at infinity with axis X,Y,Z\n"
     "(default: --up), for latitude-longitude images",
     "--lines environment --pattern image:studio.hdr"},
    {0},
};

const struct text_row TEXT_LIGHTS[] = {
    {"rectangle",
     "with centre and edges u and v; seen from both sides, or, if one-sided, only from\n"
     "the side to which u x v points (in the example: below; a part in mm)",
     "--light rectangle:one-sided --light-center 0,0,3000 --light-u 20000,0,0 "
     "--light-v 0,-20000,0"},
    {"plane", "a rectangle without end", "--light plane --pattern stripes:period=100"},
    {"tunnel", "an endless cylinder with radius u about the axis v through centre",
     "--light tunnel --pattern stripes:count=24,duty=0.3"},
    {"sphere", "a sphere at infinity with axis v; stripes are meridians",
     "--light sphere --pattern stripes:count=48"},
    {0},
};

const struct text_row TEXT_PATTERNS[] = {
    {"stripes", "bright and dark stripes along v", "--pattern stripes:count=40,duty=0.3,soft=0.1"},
    {"lattice", "stripes in both directions", "--pattern lattice:count=40,duty=0.15"},
    {"circles", "rings about the light's centre", "--pattern circles:count=40"},
    {"lines", "single lines across the light, at places from 0 to 1",
     "--pattern lines:at=0.4/0.5/0.6,width=0.01,soft=0.3"},
    {"rainbow", "hues instead of bright and dark stripes", "--pattern rainbow:count=5"},
    {"distance", "bands of equal distance along the ray to the light",
     "--pattern distance:period=50"},
    {"image",
     "an image on the light: PNG, JPEG, TIFF, OpenEXR, HDR, GIF, BMP, TGA, WebP, PNM;\n"
     "floating-point images are linear light",
     "--pattern image:grid.png"},
    {0},
};

#define KIND(kind) (1u << (kind))
#define ALL_KINDS                                                                                  \
    (KIND(SHEEN_PATTERN_STRIPES) | KIND(SHEEN_PATTERN_LATTICE) | KIND(SHEEN_PATTERN_CIRCLES) |     \
     KIND(SHEEN_PATTERN_LINES) | KIND(SHEEN_PATTERN_RAINBOW) | KIND(SHEEN_PATTERN_DISTANCE))
#define PERIODIC (ALL_KINDS & ~KIND(SHEEN_PATTERN_LINES))
#define WAVES (PERIODIC & ~KIND(SHEEN_PATTERN_RAINBOW))
#define TWO_COLOURS (ALL_KINDS & ~KIND(SHEEN_PATTERN_RAINBOW))

/* Numbers among a pattern's keys. */
static const struct number_key {
    const char *name;
    size_t member;
    enum range_name range;
    unsigned kinds; /* bits: the patterns for which it has a meaning */
} NUMBERS[] = {
    {"count", offsetof(struct sheen_pattern, count), RANGE_PATTERN_COUNT, PERIODIC},
    {"period", offsetof(struct sheen_pattern, period), RANGE_PATTERN_PERIOD, PERIODIC},
    {"duty", offsetof(struct sheen_pattern, duty), RANGE_PATTERN_DUTY, WAVES},
    {"rotation", offsetof(struct sheen_pattern, rotation_deg), RANGE_PATTERN_ROTATION, ALL_KINDS},
    {"offset", offsetof(struct sheen_pattern, offset), RANGE_PATTERN_OFFSET, PERIODIC},
    {"soft", offsetof(struct sheen_pattern, soft), RANGE_PATTERN_SOFT, TWO_COLOURS},
    {"opacity", offsetof(struct sheen_pattern, opacity), RANGE_PATTERN_OPACITY, ALL_KINDS},
    {"width", offsetof(struct sheen_pattern, width), RANGE_PATTERN_WIDTH,
     KIND(SHEEN_PATTERN_LINES)},
};
#define N_NUMBERS (sizeof(NUMBERS) / sizeof(*NUMBERS))

const struct text_row TEXT_PATTERN_KEYS[] = {
    {"count", "periods across the light (circles: to its nearer edge); not for lines",
     "default 40"},
    {"period", "length of one period, instead of count; not for lines",
     "model's units, at infinity degrees; default: by count"},
    {"duty", "bright share of a period; not for lines and rainbow", "default 0.5"},
    {"rotation", "rotation of the pattern on the light; no effect on circles and distance",
     "default 0"},
    {"offset", "shift of the pattern in periods; not for lines", "default 0"},
    {"soft",
     "width of each soft edge, as a share of a period (lines: of the width); not for rainbow",
     "default 0"},
    {"opacity", "opacity over the shaded surface (--base)", "default 1"},
    {"fg, bg", "bright and dark colour; not for rainbow",
     "#rrggbb or #rrggbbaa; default white and black"},
    {"at", "lines: up to 16 places, separated by slashes; 0 and 1 are the edges", "default 0.5"},
    {"width", "lines: width of each line, as a share of the light", "default 0.01"},
    {0},
};

/* The range of a pattern's part; NULL if the part is not a number. */
static const struct range *range_of_part(const char *name)
{
    for (size_t i = 0; i < N_NUMBERS; i++)
        if (strcmp(name, NUMBERS[i].name) == 0)
            return &RANGES[NUMBERS[i].range];
    return strcmp(name, "at") == 0 ? &RANGES[RANGE_PATTERN_AT] : NULL;
}

void text_row_example(const struct text_row *row, char text[static TEXT_EXAMPLE_BYTES])
{
    const struct range *range = range_of_part(row->name);
    char wanted[RANGE_TEXT_BYTES];
    snprintf(text, TEXT_EXAMPLE_BYTES, "%s%s%s", range ? range_text(range, wanted) : "",
             range ? "; " : "", row->example);
}

static bool __attribute__((format(printf, 2, 3))) refuse(char *why, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(why, LIGHTS_WHY_BYTES, format, arguments);
    va_end(arguments);
    return false;
}

/* The row whose name is the first `length` bytes of `text`, or -1. */
static int find_row(const struct text_row *rows, const char *text, size_t length)
{
    for (int i = 0; rows[i].name; i++)
        if (strlen(rows[i].name) == length && strncmp(rows[i].name, text, length) == 0)
            return i;
    return -1;
}

static bool parse_at(char *value, struct sheen_pattern *pattern, char *why)
{
    char *rest = value, *part, places[RANGE_TEXT_BYTES], wanted[RANGE_TEXT_BYTES];
    pattern->n_at = 0;
    while ((part = strsep(&rest, "/"))) {
        double *at = &pattern->at[pattern->n_at];
        if (!range_holds(&RANGES[RANGE_PATTERN_LINES], pattern->n_at + 1) ||
            !value_double(part, at) || !range_holds(&RANGES[RANGE_PATTERN_AT], *at))
            return refuse(why, "at must be %s numbers with slashes between, each %s",
                          range_text(&RANGES[RANGE_PATTERN_LINES], places),
                          range_text(&RANGES[RANGE_PATTERN_AT], wanted));
        pattern->n_at++;
    }
    return true;
}

/* Refuses a part that has no effect on the pattern: its name or the pattern's is probably wrong. */
static bool check_kind(unsigned kinds, const char *part, const struct sheen_pattern *pattern,
                       char *why)
{
    return kinds & KIND(pattern->kind) ||
           refuse(why, "%s changes nothing of %s; sheen patterns lists the parts", part,
                  text_pattern_kind(pattern->kind));
}

static bool parse_number(const struct number_key *key, const char *value,
                         struct sheen_pattern *pattern, char *why)
{
    double *number = (double *)(void *)((char *)pattern + key->member);
    char wanted[RANGE_TEXT_BYTES];
    return (value_double(value, number) && range_holds(&RANGES[key->range], *number)) ||
           refuse(why, "%s must be a number %s", key->name,
                  range_text(&RANGES[key->range], wanted));
}

static bool parse_part(char *part, struct sheen_pattern *pattern, char *why)
{
    char *value = strchr(part, '=');
    if (!value)
        return refuse(why, "a part has no '='; sheen patterns lists them");
    *value++ = 0;
    for (size_t i = 0; i < N_NUMBERS; i++)
        if (strcmp(part, NUMBERS[i].name) == 0)
            return check_kind(NUMBERS[i].kinds, part, pattern, why) &&
                   parse_number(&NUMBERS[i], value, pattern, why);
    if (strcmp(part, "at") == 0)
        return check_kind(KIND(SHEEN_PATTERN_LINES), part, pattern, why) &&
               parse_at(value, pattern, why);
    bool is_foreground = strcmp(part, "fg") == 0;
    if (!is_foreground && strcmp(part, "bg") != 0)
        return refuse(why, "there is no part '%.20s'; sheen patterns lists them", part);
    pattern->has_colours = true;
    return check_kind(TWO_COLOURS, part, pattern, why) &&
           (value_colour(value, is_foreground ? pattern->foreground : pattern->background) ||
            refuse(why, "fg and bg must be #rrggbb or #rrggbbaa"));
}

bool text_pattern(const char *text, struct sheen_pattern *value, const char **image_path,
                  char why[static LIGHTS_WHY_BYTES])
{
    size_t length = strcspn(text, ":");
    int kind = find_row(TEXT_PATTERNS, text, length);
    *image_path = NULL;
    *value = SHEEN_PATTERN_DEFAULTS;
    for (int k = 0; k < 4; k++)
        value->foreground[k] = 1;
    value->background[3] = 1;
    if (strncmp(text, "image:", 6) == 0) {
        value->kind = SHEEN_PATTERN_IMAGE;
        *image_path = text + 6;
        return **image_path || refuse(why, "image: needs the name of a file");
    }
    static const enum sheen_pattern_kind kinds[] = {SHEEN_PATTERN_STRIPES, SHEEN_PATTERN_LATTICE,
                                                    SHEEN_PATTERN_CIRCLES, SHEEN_PATTERN_LINES,
                                                    SHEEN_PATTERN_RAINBOW, SHEEN_PATTERN_DISTANCE};
    if (kind < 0 || (size_t)kind >= sizeof(kinds) / sizeof(*kinds))
        return refuse(why,
                      "the patterns are stripes, lattice, circles, lines, rainbow, distance and "
                      "image:FILE");
    value->kind = kinds[kind];
    if (value->kind == SHEEN_PATTERN_LINES) {
        value->n_at = 1;
        value->at[0] = 0.5;
    }
    char parts[512];
    const char *from = text + length + (text[length] == ':');
    if (text[length] == ':' && !*from)
        return refuse(why, "nothing follows the ':'; sheen patterns lists the parts");
    if (strlen(from) >= sizeof(parts))
        return refuse(why, "it is longer than %zu characters", sizeof(parts));
    snprintf(parts, sizeof(parts), "%s", from);
    char *rest = *parts ? parts : NULL, *part;
    bool has_count = false;
    while ((part = strsep(&rest, ","))) {
        if (!parse_part(part, value, why))
            return false;
        /* parse_part() has cut the text at '='. */
        has_count = has_count || strcmp(part, "count") == 0;
    }
    return !(has_count && value->period > 0) || refuse(why, "count and period exclude each other");
}

bool text_light(const char *text, struct sheen_light *value, char why[static LIGHTS_WHY_BYTES])
{
    size_t length = strcspn(text, ":");
    int kind = find_row(TEXT_LIGHTS, text, length);
    if (kind < 0)
        return refuse(why, "the lights are rectangle, plane, tunnel and sphere");
    value->kind = (enum sheen_light_kind)kind;
    value->has_kind = true;
    value->one_sided = strcmp(text + length, ":one-sided") == 0;
    if (text[length] && !value->one_sided)
        return refuse(why, "only one-sided may follow the ':'");
    return !value->one_sided || kind <= SHEEN_LIGHT_PLANE ||
           refuse(why, "one-sided is for rectangle and plane");
}

bool text_lines(const char *text, struct sheen_lines *value, char why[static LIGHTS_WHY_BYTES])
{
    size_t length = strcspn(text, ":");
    int family = find_row(TEXT_FAMILIES, text, length);
    if (family < 0)
        return refuse(why, "must be reflection, highlight, isophote, zebra or environment");
    value->family = (enum sheen_line_family)family;
    value->has_direction = text[length] == ':';
    if (!value->has_direction)
        return true;
    if (family == SHEEN_LINES_REFLECTION || family == SHEEN_LINES_HIGHLIGHT)
        return refuse(why, "a direction belongs to isophote, zebra and environment");
    return value_direction(text + length + 1, value->direction) ||
           refuse(why, "the direction must be " VALUE_DIRECTION_WORDS);
}

bool text_line_eye(const char *text, struct sheen_lines *value, char why[static LIGHTS_WHY_BYTES])
{
    bool is_direction = strncmp(text, "dir:", 4) == 0;
    if (strcmp(text, "camera") == 0) {
        value->eye_kind = SHEEN_LINE_EYE_CAMERA;
        return true;
    }
    value->eye_kind = is_direction ? SHEEN_LINE_EYE_DIRECTION : SHEEN_LINE_EYE_POINT;
    return (is_direction ? value_direction(text + 4, value->eye) : value_vec3(text, value->eye)) ||
           refuse(why, "must be camera, a point X,Y,Z or a direction of view dir:X,Y,Z or dir:-z, "
                       "not 0,0,0");
}

static const struct text_row SHOW_KINDS[] = {
    {.name = "lines"},  {.name = "curvature"}, {.name = "gaussian"}, {.name = "mean"},
    {.name = "normal"}, {.name = "ptex"},      {.name = "draft"},    {0}};

bool text_show(const char *text, struct sheen_show *value, char why[static LIGHTS_WHY_BYTES])
{
    size_t length = strcspn(text, ":");
    int kind = find_row(SHOW_KINDS, text, length);
    if (kind < 0 || (kind != SHEEN_SHOW_DRAFT && text[length]))
        return refuse(why, "must be curvature, gaussian, mean, normal, ptex, draft:X,Y,Z or lines");
    value->kind = (enum sheen_show_kind)kind;
    return kind != SHEEN_SHOW_DRAFT ||
           (text[length] && value_direction(text + length + 1, value->direction)) ||
           refuse(why, "draft needs the pull direction, as draft:0,0,1: " VALUE_DIRECTION_WORDS);
}

const char *text_pattern_kind(enum sheen_pattern_kind kind)
{
    static const char *const names[] = {"stripes", "lattice", "circles", "image",
                                        "lines",   "rainbow", "distance"};
    return names[kind];
}

const char *text_light_kind(enum sheen_light_kind kind)
{
    return TEXT_LIGHTS[kind].name;
}

const char *text_line_family(enum sheen_line_family family)
{
    return TEXT_FAMILIES[family].name;
}

const char *text_show_kind(enum sheen_show_kind kind)
{
    return SHOW_KINDS[kind].name;
}
