/* The folder of the programs under test, for tests that start them. */
#ifndef SHEEN_TESTS_BUILD_FOLDER_H
#define SHEEN_TESTS_BUILD_FOLDER_H

#include <limits.h>
#include <string.h>
#include <unistd.h>

/* Returns BUILD, because tests are BUILD/tests/NAME. A static buffer. */
static inline const char *build_folder(void)
{
    static char path[PATH_MAX];
    ssize_t n = readlink("/proc/self/exe", path, sizeof path - 1);
    path[n > 0 ? n : 0] = 0;
    for (int i = 0; i < 2; i++) {
        char *slash = strrchr(path, '/');
        if (slash)
            *slash = 0;
    }
    return path;
}

#endif
