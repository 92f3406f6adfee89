#include "server/base/plain_file.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>

bool plain_file_check(const char *path, struct error *error)
{
    struct stat file;
    if (stat(path, &file) < 0)
        return error_set(error, ERROR_REQUEST, "cannot read %s: %s", path, strerror(errno));
    return S_ISREG(file.st_mode) ||
           error_set(error, ERROR_REQUEST, "cannot read %s: it is no plain file", path);
}
