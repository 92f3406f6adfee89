#include "client/cli/options/frame_names.h"

#include <ctype.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

bool frame_names_parse(const char *path, struct frame_names *names)
{
    const char *at = strchr(path, '%'), *slash = strrchr(path, '/');
    if (!at || (slash && slash > at))
        return false;
    const char *from = at + 1;
    *names = (struct frame_names){.path = path, .n_before = (int)(at - path)};
    if (*from == '0') {
        names->has_zeros = true;
        from++;
    }
    if (isdigit((unsigned char)*from))
        names->width = *from++ - '0';
    names->after = from + 1;
    return *from == 'd' && !strchr(names->after, '%') && names->has_zeros <= (names->width > 0);
}

char *frame_names_path(const struct frame_names *names, uint32_t number)
{
    char digits[16], *path;
    snprintf(digits, sizeof(digits), names->has_zeros ? "%0*" PRIu32 : "%*" PRIu32, names->width,
             number);
    return asprintf(&path, "%.*s%s%s", names->n_before, names->path, digits, names->after) < 0
               ? NULL
               : path;
}
