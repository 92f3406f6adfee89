#include "client/values.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

bool value_double(const char *text, double *value)
{
    /* strtod() takes more than a person means by a number: white space, hex, nan, inf. */
    if (strspn(text, "+-.0123456789eE") != strlen(text) || *text == 0)
        return false;
    char *end;
    errno = 0;
    *value = strtod(text, &end);
    return *end == 0 && end != text && isfinite(*value) && !(errno == ERANGE && *value != 0);
}

bool value_uint32(const char *text, uint32_t *value)
{
    if (!isdigit((unsigned char)*text))
        return false;
    uint64_t sum = 0;
    for (; isdigit((unsigned char)*text); text++) {
        sum = sum * 10 + (uint64_t)(*text - '0');
        if (sum > UINT32_MAX)
            return false;
    }
    *value = (uint32_t)sum;
    return *text == 0;
}

/* Copies the part before `stop` (or all) and steps over it; false when it does not fit. */
static bool next_part(const char **text, char stop, char *part, size_t part_bytes)
{
    const char *end = strchrnul(*text, stop);
    size_t length = (size_t)(end - *text);
    if (length >= part_bytes)
        return false;
    memcpy(part, *text, length);
    part[length] = 0;
    *text = *end ? end + 1 : end;
    return true;
}

bool value_vec3(const char *text, double value[static 3])
{
    char part[64];
    for (int i = 0; i < 3; i++) {
        bool has_comma = strchr(text, ',') != NULL;
        if (has_comma != (i < 2) || !next_part(&text, ',', part, sizeof(part)) ||
            !value_double(part, &value[i]))
            return false;
    }
    return true;
}

bool value_size(const char *text, uint32_t *width, uint32_t *height)
{
    char part[16];
    return strchr(text, 'x') && next_part(&text, 'x', part, sizeof(part)) &&
           value_uint32(part, width) && value_uint32(text, height) && *width > 0 && *height > 0;
}

bool value_colour(const char *text, float value[static 4])
{
    size_t length = strlen(text);
    if (text[0] != '#' || (length != 7 && length != 9) ||
        strspn(text + 1, "0123456789abcdefABCDEF") != length - 1)
        return false;
    value[3] = 1;
    for (size_t i = 0; i < (length - 1) / 2; i++) {
        const char digits[3] = {text[1 + 2 * i], text[2 + 2 * i], 0};
        value[i] = (float)strtoul(digits, NULL, 16) / 255.0f;
    }
    return true;
}

bool value_planes(const char *text, uint32_t *planes)
{
    static const struct {
        const char *name;
        uint32_t plane;
    } names[] = {{"P", SHEEN_POSITION},
                 {"N", SHEEN_NORMAL},
                 {"ptex", SHEEN_PTEX},
                 {"light", SHEEN_LIGHT},
                 {"k", SHEEN_CURVATURE}};
    char part[16];
    *planes = 0;
    size_t length = strlen(text);
    if (length == 0 || text[length - 1] == ',')
        return false;
    while (*text) {
        if (!next_part(&text, ',', part, sizeof(part)))
            return false;
        size_t i = 0;
        while (i < sizeof(names) / sizeof(*names) && strcmp(names[i].name, part) != 0)
            i++;
        if (i == sizeof(names) / sizeof(*names))
            return false;
        *planes |= names[i].plane;
    }
    return true;
}

static bool refuse(char *why, const char *text)
{
    snprintf(why, VALUES_WHY_BYTES, "%s", text);
    return false;
}

static bool pattern_part(char *part, struct sheen_pattern *pattern, char *why)
{
    char *equals = strchr(part, '=');
    if (!equals)
        return refuse(why, "a part has no '='; parts are count= duty= fg= bg=");
    *equals = 0;
    const char *value = equals + 1;
    if (strcmp(part, "count") == 0)
        return (value_double(value, &pattern->count) && pattern->count > 0 &&
                pattern->count <= 100000) ||
               refuse(why, "count must be a number above 0 and at most 100000");
    if (strcmp(part, "duty") == 0)
        return (value_double(value, &pattern->duty) && pattern->duty >= 0 && pattern->duty <= 1) ||
               refuse(why, "duty must be a number from 0 to 1");
    bool is_foreground = strcmp(part, "fg") == 0;
    if (!is_foreground && strcmp(part, "bg") != 0)
        return refuse(why, "the parts are count= duty= fg= bg=");
    pattern->has_colours = true;
    return value_colour(value, is_foreground ? pattern->foreground : pattern->background) ||
           refuse(why, "fg and bg must be #rrggbb or #rrggbbaa");
}

bool value_pattern(const char *text, struct sheen_pattern *pattern, const char **image_path,
                   char why[static VALUES_WHY_BYTES])
{
    static const char *const kinds[] = {
        [SHEEN_STRIPES] = "stripes",
        [SHEEN_LATTICE] = "lattice",
        [SHEEN_CIRCLES] = "circles",
    };
    *image_path = NULL;
    *pattern = (struct sheen_pattern){
        .count = 40, .duty = 0.5, .foreground = {1, 1, 1, 1}, .background = {0, 0, 0, 1}};
    if (strncmp(text, "image:", 6) == 0) {
        pattern->kind = SHEEN_IMAGE;
        *image_path = text + 6;
        return **image_path || refuse(why, "image: needs the name of a file");
    }
    char part[64];
    bool has_parts = strchr(text, ':') != NULL;
    size_t kind = 0;
    if (!next_part(&text, ':', part, sizeof(part)))
        return refuse(why, "the patterns are stripes, lattice, circles and image:FILE");
    while (kind <= SHEEN_CIRCLES && strcmp(kinds[kind], part) != 0)
        kind++;
    if (kind > SHEEN_CIRCLES)
        return refuse(why, "the patterns are stripes, lattice, circles and image:FILE");
    pattern->kind = (enum sheen_pattern_kind)kind;
    if (has_parts && !*text)
        return refuse(why, "nothing follows the ':'; parts are count= duty= fg= bg=");
    while (*text) {
        if (!next_part(&text, ',', part, sizeof(part)))
            return refuse(why, "a part is too long; parts are count= duty= fg= bg=");
        if (!pattern_part(part, pattern, why))
            return false;
    }
    return true;
}

bool value_format(const char *path, enum sheen_format *format)
{
    static const struct {
        const char *ending;
        enum sheen_format format;
    } endings[] = {{".png", SHEEN_FILE_PNG},  {".exr", SHEEN_FILE_EXR},
                   {".jpg", SHEEN_FILE_JPEG}, {".jpeg", SHEEN_FILE_JPEG},
                   {".tif", SHEEN_FILE_TIFF}, {".tiff", SHEEN_FILE_TIFF}};
    const char *slash = strrchr(path, '/');
    const char *name = slash ? slash + 1 : path;
    const char *dot = strrchr(name, '.');
    for (size_t i = 0; dot && dot != name && i < sizeof(endings) / sizeof(*endings); i++)
        if (strcasecmp(dot, endings[i].ending) == 0) {
            *format = endings[i].format;
            return true;
        }
    return false;
}
