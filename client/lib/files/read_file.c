#include "client/lib/files/read_file.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/openat2.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "client/lib/status.h"
#include "protocol/limits.h"

static enum sheen_status read_open(int fd, const char *path, enum sheen_status status,
                                   uint8_t **bytes, size_t *n_bytes, struct sheen_error *error)
{
    struct stat about;
    if (fstat(fd, &about) != 0)
        return status_set(error, status, "%s: %s", path, strerror(errno));
    if (!S_ISREG(about.st_mode))
        return status_set(error, status, "%s: is not a plain file", path);
    if (about.st_size == 0)
        return status_set(error, status, "%s: is empty", path);
    if ((uint64_t)about.st_size > PROTOCOL_MAX_UPLOAD_BYTES)
        return status_set(error, SHEEN_TOO_BIG, "%s: %lld bytes; at most %llu can be uploaded",
                          path, (long long)about.st_size,
                          (unsigned long long)PROTOCOL_MAX_UPLOAD_BYTES);
    size_t size = (size_t)about.st_size;
    uint8_t *buffer = malloc(size);
    if (!buffer)
        return status_set(error, SHEEN_NO_MEMORY, "%s: no memory for %zu bytes", path, size);
    for (size_t done = 0; done < size;) {
        ssize_t n = read(fd, buffer + done, size - done);
        if (n > 0) {
            done += (size_t)n;
        } else if (n == 0 || errno != EINTR) {
            const char *why = n == 0 ? "it became shorter while it was read" : strerror(errno);
            free(buffer);
            return status_set(error, status, "%s: %s", path, why);
        }
    }
    *bytes = buffer;
    *n_bytes = size;
    return SHEEN_OK;
}

#define READ_FLAGS (O_RDONLY | O_CLOEXEC | O_NONBLOCK) /* opening a FIFO must not block */

/* Reads and closes the descriptor; -1, with errno: the file could not be opened. */
static enum sheen_status read_and_close(int fd, const char *path, enum sheen_status status,
                                        uint8_t **bytes, size_t *n_bytes, struct sheen_error *error)
{
    if (fd < 0)
        return status_set(error, status, "%s: %s", path, strerror(errno));
    enum sheen_status result = read_open(fd, path, status, bytes, n_bytes, error);
    close(fd);
    return result;
}

enum sheen_status read_file(const char *path, enum sheen_status status, uint8_t **bytes,
                            size_t *n_bytes, struct sheen_error *error)
{
    return read_and_close(open(path, READ_FLAGS), path, status, bytes, n_bytes, error);
}

enum sheen_status read_file_linkless(const char *path, enum sheen_status status, uint8_t **bytes,
                                     size_t *n_bytes, struct sheen_error *error)
{
    struct open_how how = {.flags = READ_FLAGS, .resolve = RESOLVE_NO_SYMLINKS};
    int fd = (int)syscall(SYS_openat2, AT_FDCWD, path, &how, sizeof(how));
    if (fd < 0 && (errno == ENOSYS || errno == EPERM)) /* before Linux 5.6, or in a sandbox */
        fd = open(path, READ_FLAGS | O_NOFOLLOW);
    return read_and_close(fd, path, status, bytes, n_bytes, error);
}
