/* Writes files below a folder of a test, as a stand-in for the system's files. */
#ifndef SHEEN_TESTS_UNIT_FILE_TREE_H
#define SHEEN_TESTS_UNIT_FILE_TREE_H

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

/* Writes the file folder + path, and makes the folders of `path`, which begins with '/'. */
static inline void put_below(const char *folder, const char *path, const char *text)
{
    char whole[300], *slash;
    snprintf(whole, sizeof whole, "%s%s", folder, path);
    for (slash = strchr(whole + strlen(folder) + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = 0;
        mkdir(whole, 0700);
        *slash = '/';
    }
    FILE *file = fopen(whole, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

#endif
