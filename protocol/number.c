#include "protocol/number.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

bool number_parse(const char *value, uint64_t low, uint64_t high, bool suffixes, uint64_t *number)
{
    if (*value < '0' || *value > '9')
        return false;
    char *end;
    errno = 0;
    uint64_t n = strtoull(value, &end, 10);
    const char *suffix = suffixes && *end ? strchr("KMGT", *end) : NULL;
    if (suffix) {
        end++;
        for (long i = suffix - "KMGT"; errno == 0 && i >= 0; i--)
            errno = __builtin_mul_overflow(n, 1024, &n) ? ERANGE : 0;
    }
    *number = n;
    return errno == 0 && *end == 0 && n >= low && n <= high;
}
