/* For LD_PRELOAD: simulates a machine without the libraries named in $SHEEN_NO_LIBRARIES, which has
 * a space before and after each name. */
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void *dlopen(const char *name, int flags)
{
    void *(*open)(const char *, int);
    void *symbol = dlsym(RTLD_NEXT, "dlopen");
    const char *missing = getenv("SHEEN_NO_LIBRARIES");
    char word[256];
    snprintf(word, sizeof word, " %s ", name ? name : "");
    if (name && missing && strstr(missing, word))
        name = "libmissing.so.0"; /* so that dlerror() returns a text */
    memcpy(&open, &symbol, sizeof open);
    return open(name, flags);
}
