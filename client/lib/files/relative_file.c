#include "client/lib/files/relative_file.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "client/lib/files/read_file.h"
#include "client/lib/status.h"

#define SHOWN_URI "%.120s"

/* RFC 3986, section 3.1: a scheme is what precedes a colon, without a slash before it. */
static bool has_scheme(const char *uri)
{
    size_t n = strspn(uri, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789+-.");
    return n > 0 && isalpha((unsigned char)uri[0]) && uri[n] == ':';
}

bool relative_file_is_data(const char *uri)
{
    return strncasecmp(uri, "data:", 5) == 0;
}

static int hex_digit(char c)
{
    if (c >= '0' && c <= '9')
        return c - '0';
    c |= 0x20;
    return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

/* Decodes in place. Many programs encode nothing, so a '%' without two hexadecimal digits stands
 * for itself. False if a decoded byte is 0. */
static bool decode_percent(char *text)
{
    char *to = text;
    for (const char *from = text; *from; to++) {
        int high = *from == '%' ? hex_digit(from[1]) : -1;
        int low = high >= 0 ? hex_digit(from[2]) : -1;
        *to = low >= 0 ? (char)(high << 4 | low) : *from;
        if (!*to)
            return false;
        from += low >= 0 ? 3 : 1;
    }
    *to = 0;
    return true;
}

static bool goes_up(const char *path)
{
    for (const char *at = path; at; at = strchr(at, '/')) {
        at += *at == '/';
        if (at[0] == '.' && at[1] == '.' && (at[2] == '/' || !at[2]))
            return true;
    }
    return false;
}

/* Returns what is wrong with the URI; or NULL, and *path, which the caller frees. */
static const char *relative_path(const char *uri, char **path)
{
    if (has_scheme(uri))
        return "is a URL: nothing is fetched; put the file into the model's folder and name it "
               "without";
    char *decoded = strdup(uri);
    if (!decoded)
        return "is too long for the memory";
    const char *problem = NULL;
    if (!decode_percent(decoded))
        problem = "holds a zero byte";
    else if (!*decoded)
        problem = "names no file";
    else if (decoded[0] == '/' || goes_up(decoded))
        problem = "is outside of the model's folder, where nothing is read";
    if (problem)
        free(decoded);
    else
        *path = decoded;
    return problem;
}

/* True if `file` is below `folder`. Both must come from realpath(). */
static bool is_below(const char *file, const char *folder)
{
    size_t n = strlen(folder);
    if (strcmp(folder, "/") == 0)
        return true;
    return strncmp(file, folder, n) == 0 && file[n] == '/';
}

static enum sheen_status read_below(const char *folder, const char *uri, const char *joined,
                                    uint64_t most, uint8_t **bytes, size_t *n_bytes,
                                    struct sheen_error *error)
{
    char *real = realpath(joined, NULL);
    if (!real)
        return status_set(error, SHEEN_BAD_MODEL, "%s: %s; the model needs it", joined,
                          strerror(errno));
    struct stat about;
    enum sheen_status status;
    if (!is_below(real, folder))
        status = status_set(error, SHEEN_BAD_MODEL,
                            "'" SHOWN_URI "' is a link to outside of the model's folder, where "
                            "nothing is read",
                            uri);
    else if (stat(real, &about) == 0 && about.st_size > 0 && (uint64_t)about.st_size > most)
        status =
            status_set(error, SHEEN_TOO_BIG, "%s: %lld bytes", joined, (long long)about.st_size);
    else
        status = read_file_linkless(real, SHEEN_BAD_MODEL, bytes, n_bytes, error);
    free(real);
    return status;
}

enum sheen_status relative_file_read(const char *path, const char *uri, uint64_t most,
                                     uint8_t **bytes, size_t *n_bytes, struct sheen_error *error)
{
    char *relative = NULL, *joined = NULL;
    const char *problem = relative_path(uri, &relative);
    if (problem)
        return status_set(error, SHEEN_BAD_MODEL, "'" SHOWN_URI "' %s", uri, problem);
    const char *slash = strrchr(path, '/');
    int folder_bytes = slash ? (int)(slash - path) + 1 : 0;
    enum sheen_status status = SHEEN_NO_MEMORY;
    char *folder = NULL;
    if (asprintf(&joined, "%.*s%s", folder_bytes, path, relative) < 0) {
        joined = NULL;
        status_set(error, status, "no memory for a path");
        goto done;
    }
    char *folder_name = slash ? strndup(path, (size_t)folder_bytes) : strdup(".");
    folder = folder_name ? realpath(folder_name, NULL) : NULL;
    free(folder_name);
    if (folder)
        status = read_below(folder, uri, joined, most, bytes, n_bytes, error);
    else
        status = status_set(error, SHEEN_BAD_MODEL, "the model's folder: %s", strerror(errno));
done:
    free(folder);
    free(joined);
    free(relative);
    return status;
}
