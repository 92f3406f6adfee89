#include "client/cli/files/file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "client/cli/base/failure.h"

#define TEMPORARY_TRIES 100

enum sheen_status file_read_line(const char *path, char *line, size_t size,
                                 struct sheen_error *error)
{
    FILE *file = fopen(path, "re");
    if (!file)
        return failure_set(error, SHEEN_BAD_ARGUMENT, "cannot read %s: %s", path, strerror(errno));
    bool ok = fgets(line, (int)size, file) != NULL;
    size_t length = ok ? strcspn(line, "\r\n") : 0;
    bool whole = ok && (line[length] || feof(file));
    fclose(file);
    if (length == 0 || !whole)
        return failure_set(error, SHEEN_BAD_ARGUMENT,
                           "%s: its first line must be a text of 1 to %zu bytes", path, size - 2);
    line[length] = 0;
    return SHEEN_OK;
}

/* The folder of `path`; the caller frees it. NULL when memory is short. */
static char *folder_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? strndup(path, slash == path ? 1 : (size_t)(slash - path)) : strdup(".");
}

enum sheen_status file_check_writable(const char *path, struct sheen_error *error)
{
    struct stat about;
    if (stat(path, &about) == 0 && !S_ISREG(about.st_mode))
        return failure_set(error, SHEEN_BAD_IMAGE, "%s: is there and is not a plain file", path);
    char *folder = folder_of(path);
    if (!folder)
        return failure_set(error, SHEEN_NO_MEMORY, "no memory for a path");
    int reason = access(folder, W_OK | X_OK) == 0 ? 0 : errno;
    free(folder);
    return reason ? failure_set(error, SHEEN_BAD_IMAGE, "%s: cannot be written: %s", path,
                                strerror(reason))
                  : SHEEN_OK;
}

static bool write_all(int fd, const uint8_t *bytes, size_t n_bytes)
{
    while (n_bytes > 0) {
        ssize_t n = write(fd, bytes, n_bytes);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return false;
        bytes += n;
        n_bytes -= (size_t)n;
    }
    return true;
}

/* Opens a file without a name, which vanishes if this process is killed. -1 if the file system has
 * none. */
static int open_nameless(const char *path)
{
    char *folder = folder_of(path);
    bool can_link = access("/proc/self/fd", X_OK) == 0; /* see name_temporary() */
    int fd = folder && can_link ? open(folder, O_WRONLY | O_TMPFILE | O_CLOEXEC, 0666) : -1;
    free(folder);
    return fd;
}

/* Gives the nameless file a name in the folder of `path`, or makes a new file there if `nameless`
 * is -1. Returns its descriptor; the caller frees the name. -1 and errno on failure. */
static int name_temporary(const char *path, int nameless, char **name)
{
    char link[32];
    snprintf(link, sizeof(link), "/proc/self/fd/%d", nameless);
    for (int i = 0; i < TEMPORARY_TRIES; i++) {
        if (asprintf(name, "%s.%ld-%d.tmp", path, (long)getpid(), i) < 0)
            break;
        int fd = nameless;
        if (nameless < 0)
            fd = open(*name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        else if (linkat(AT_FDCWD, link, AT_FDCWD, *name, AT_SYMLINK_FOLLOW) != 0)
            fd = -1;
        if (fd >= 0)
            return fd;
        int reason = errno;
        free(*name);
        errno = reason;
        if (reason != EEXIST)
            break;
    }
    *name = NULL;
    return -1;
}

enum sheen_status file_write(const char *path, const uint8_t *bytes, size_t n_bytes,
                             struct sheen_error *error)
{
    char *name = NULL;
    int nameless = open_nameless(path);
    int fd = nameless >= 0 ? nameless : name_temporary(path, -1, &name);
    bool is_written = fd >= 0 && write_all(fd, bytes, n_bytes) &&
                      (nameless < 0 || name_temporary(path, nameless, &name) >= 0);
    int reason = errno;
    if (fd >= 0 && close(fd) != 0 && is_written) {
        is_written = false;
        reason = errno;
    }
    if (is_written && rename(name, path) != 0) {
        is_written = false;
        reason = errno;
    }
    if (!is_written && name)
        unlink(name);
    free(name);
    return is_written ? SHEEN_OK
                      : failure_set(error, SHEEN_BAD_IMAGE, "%s: cannot be written: %s", path,
                                    strerror(reason));
}
