#include "client/cli/options/values.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "protocol/ranges.h"

bool value_double(const char *text, double *value)
{
    /* strtod() accepts more than people mean by a number: white space, hexadecimal, nan, inf. */
    if (strspn(text, "+-.0123456789eE") != strlen(text) || *text == 0)
        return false;
    char *end;
    *value = strtod(text, &end);
    return *end == 0 && end != text && isfinite(*value);
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

/* Copies the text before `stop` (or all of it) and steps over it. False if it does not fit. */
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

bool value_numbers(const char *text, double *value, unsigned n)
{
    char part[64];
    for (unsigned i = 0; i < n; i++) {
        bool has_comma = strchr(text, ',') != NULL;
        if (has_comma != (i + 1 < n) || !next_part(&text, ',', part, sizeof(part)) ||
            !value_double(part, &value[i]))
            return false;
    }
    return true;
}

bool value_vec3(const char *text, double value[static 3])
{
    if (!value_numbers(text, value, 3))
        return false;
    for (int i = 0; i < 3; i++)
        if (!range_holds(&RANGES[RANGE_COORDINATE], value[i]))
            return false;
    return true;
}

/* x, y or z, with an optional sign. */
static bool value_axis(const char *text, double value[static 3])
{
    bool has_sign = *text == '-' || *text == '+';
    const char *axis = text + has_sign;
    if (strlen(axis) != 1 || *axis < 'x' || *axis > 'z')
        return false;
    for (int i = 0; i < 3; i++)
        value[i] = *axis - 'x' == i ? (*text == '-' ? -1 : 1) : 0;
    return true;
}

bool value_direction(const char *text, double value[static 3])
{
    return value_axis(text, value) || (value_vec3(text, value) && !range_is_zero(value));
}

const char *value_noun(uint64_t number, const char *one, const char *many)
{
    return number == 1 ? one : many;
}

bool value_size(const char *text, uint32_t *width, uint32_t *height)
{
    char part[16];
    return strchr(text, 'x') && next_part(&text, 'x', part, sizeof(part)) &&
           value_uint32(part, width) && value_uint32(text, height) &&
           range_holds(&RANGES[RANGE_SIDE], *width) && range_holds(&RANGES[RANGE_SIDE], *height);
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

static const struct {
    const char *name;
    uint32_t plane;
} PLANES[] = {{"P", SHEEN_PLANE_POSITION},       {"N", SHEEN_PLANE_NORMAL},
              {"ptex", SHEEN_PLANE_PTEX},        {"light", SHEEN_PLANE_LIGHT},
              {"k", SHEEN_PLANE_CURVATURE},      {"dlight", SHEEN_PLANE_LIGHT_CHANGE},
              {"coverage", SHEEN_PLANE_COVERAGE}};
#define N_PLANES (sizeof(PLANES) / sizeof(*PLANES))

const char *value_plane_name(uint32_t plane)
{
    for (size_t i = 0; i < N_PLANES; i++)
        if (PLANES[i].plane == plane)
            return PLANES[i].name;
    return NULL;
}

bool value_planes(const char *text, uint32_t *planes)
{
    char part[16];
    *planes = 0;
    size_t length = strlen(text);
    if (length == 0 || text[length - 1] == ',')
        return false;
    while (*text) {
        if (!next_part(&text, ',', part, sizeof(part)))
            return false;
        size_t i = 0;
        while (i < N_PLANES && strcmp(PLANES[i].name, part) != 0)
            i++;
        if (i == N_PLANES)
            return false;
        *planes |= PLANES[i].plane;
    }
    return true;
}

bool value_surface(const char *text, enum sheen_surface *surface, uint32_t *level)
{
    static const char *const kinds[] = {"exact", "polygon", "wireframe"};
    char kind[16];
    *level = 0;
    *surface = SHEEN_SURFACE_EXACT;
    if (strcmp(text, kinds[SHEEN_SURFACE_EXACT]) == 0)
        return true;
    if (!next_part(&text, ':', kind, sizeof(kind)))
        return false;
    for (int k = SHEEN_SURFACE_POLYGON; k <= SHEEN_SURFACE_WIREFRAME; k++)
        if (strcmp(kind, kinds[k]) == 0)
            *surface = (enum sheen_surface)k;
    return *surface != SHEEN_SURFACE_EXACT && value_uint32(text, level) &&
           range_holds(&RANGES[RANGE_LEVEL], *level);
}

bool value_format(const char *path, enum sheen_format *format)
{
    static const struct {
        const char *ending;
        enum sheen_format format;
    } endings[] = {{".png", SHEEN_FORMAT_PNG},  {".exr", SHEEN_FORMAT_EXR},
                   {".jpg", SHEEN_FORMAT_JPEG}, {".jpeg", SHEEN_FORMAT_JPEG},
                   {".tif", SHEEN_FORMAT_TIFF}, {".tiff", SHEEN_FORMAT_TIFF}};
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

static const char *const SUBSAMPLINGS[] = {"444", "422", "420"};

bool value_subsampling(const char *text, enum sheen_jpeg_subsampling *subsampling)
{
    for (size_t i = 0; i < sizeof(SUBSAMPLINGS) / sizeof(*SUBSAMPLINGS); i++) {
        *subsampling = (enum sheen_jpeg_subsampling)i;
        if (strcmp(text, SUBSAMPLINGS[i]) == 0)
            return true;
    }
    return false;
}

const char *value_subsampling_name(enum sheen_jpeg_subsampling subsampling)
{
    return SUBSAMPLINGS[subsampling];
}

static const char *const CLASS_NAMES[] = {
    [SHEEN_CLASS_STILL] = "still",
    [SHEEN_CLASS_INTERACTIVE] = "interactive",
    [SHEEN_CLASS_BATCH] = "batch",
};

bool value_class(const char *text, enum sheen_class *request_class)
{
    for (size_t i = 0; i < sizeof(CLASS_NAMES) / sizeof(*CLASS_NAMES); i++) {
        *request_class = (enum sheen_class)i;
        if (strcmp(text, CLASS_NAMES[i]) == 0)
            return true;
    }
    return false;
}

const char *value_class_name(enum sheen_class request_class)
{
    return CLASS_NAMES[request_class];
}

static const char *const VIEW_NAMES[] = {
    [SHEEN_VIEW_AROUND] = NULL,     [SHEEN_VIEW_FRONT] = "front", [SHEEN_VIEW_BACK] = "back",
    [SHEEN_VIEW_LEFT] = "left",     [SHEEN_VIEW_RIGHT] = "right", [SHEEN_VIEW_TOP] = "top",
    [SHEEN_VIEW_BOTTOM] = "bottom", [SHEEN_VIEW_ISO] = "iso",
};

bool value_view(const char *text, enum sheen_view *view)
{
    for (int i = SHEEN_VIEW_FRONT; i <= SHEEN_VIEW_ISO; i++) {
        *view = (enum sheen_view)i;
        if (strcmp(text, VIEW_NAMES[i]) == 0)
            return true;
    }
    return false;
}

const char *value_view_name(enum sheen_view view)
{
    return VIEW_NAMES[view];
}

bool value_zoom(const char *text, double *factor, double at[static 2])
{
    char part[64];
    bool has_place = strchr(text, '@') != NULL;
    at[0] = at[1] = 0.5;
    if (!next_part(&text, '@', part, sizeof(part)) || !value_double(part, factor))
        return false;
    if (!has_place)
        return true;
    bool has_comma = strchr(text, ',') != NULL;
    return has_comma && next_part(&text, ',', part, sizeof(part)) && value_double(part, &at[0]) &&
           value_double(text, &at[1]);
}
