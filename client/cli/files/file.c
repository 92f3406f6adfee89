#include "client/cli/files/file.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "client/cli/base/failure.h"

#define TEMPORARY_TRIES 100
#define MAX_LINKS 40 /* symbolic links that are followed in a row, as the kernel does */

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

/* The path that the text of the symbolic link at `path` means. The caller frees it. NULL and errno
 * when memory is short. */
static char *path_of_link(const char *path, const char *text)
{
    char *end = NULL;
    const char *slash = text[0] == '/' ? NULL : strrchr(path, '/');
    int folder_length = slash ? (int)(slash - path) + 1 : 0;
    return asprintf(&end, "%.*s%s", folder_length, path, text) < 0 ? NULL : end;
}

/* The file that is written for `path`: where `path` is a symbolic link, the end of the chain of
 * links, whether it exists or not. The caller frees it. NULL and errno on failure. */
static char *target_of(const char *path)
{
    char text[PATH_MAX], *target = strdup(path);
    for (int i = 0; target; i++) {
        ssize_t n = readlink(target, text, sizeof(text) - 1);
        if (n < 0)
            return target; /* no link */
        text[n] = 0;
        char *next = i < MAX_LINKS ? path_of_link(target, text) : NULL;
        free(target);
        target = next;
        if (i == MAX_LINKS)
            errno = ELOOP;
    }
    return NULL;
}

static enum sheen_status refuse_writing(const char *path, int reason, struct sheen_error *error)
{
    return failure_set(error, SHEEN_BAD_IMAGE, "%s: cannot be written: %s", path, strerror(reason));
}

/* Why no file can be made in `folder`, as errno's value; 0: it can. */
static int folder_refuses(const char *folder)
{
    struct stat about;
    if (stat(folder, &about) != 0)
        return errno;
    if (!S_ISDIR(about.st_mode))
        return ENOTDIR;
    return access(folder, W_OK | X_OK) == 0 ? 0 : errno;
}

enum sheen_status file_check_writable(const char *path, struct sheen_error *error)
{
    struct stat about;
    if (stat(path, &about) == 0 && !S_ISREG(about.st_mode))
        return failure_set(error, SHEEN_BAD_IMAGE, "%s: exists and is not a regular file", path);
    char *target = target_of(path);
    char *folder = target ? folder_of(target) : NULL;
    int reason = folder ? folder_refuses(folder) : errno;
    free(folder);
    free(target);
    return reason ? refuse_writing(path, reason, error) : SHEEN_OK;
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

/* Writes the file at `path`, which is no link. Returns errno's value, 0 for success. */
static int write_whole(const char *path, const uint8_t *bytes, size_t n_bytes)
{
    char *name = NULL;
    int nameless = open_nameless(path);
    int fd = nameless >= 0 ? nameless : name_temporary(path, -1, &name);
    bool is_written = fd >= 0 && write_all(fd, bytes, n_bytes) &&
                      (nameless < 0 || name_temporary(path, nameless, &name) >= 0);
    int reason = is_written ? 0 : errno;
    if (fd >= 0 && close(fd) != 0 && !reason)
        reason = errno;
    if (!reason && rename(name, path) != 0)
        reason = errno;
    if (reason && name)
        unlink(name);
    free(name);
    return reason;
}

enum sheen_status file_write(const char *path, const uint8_t *bytes, size_t n_bytes,
                             struct sheen_error *error)
{
    char *target = target_of(path);
    int reason = target ? write_whole(target, bytes, n_bytes) : errno;
    free(target);
    return reason ? refuse_writing(path, reason, error) : SHEEN_OK;
}
