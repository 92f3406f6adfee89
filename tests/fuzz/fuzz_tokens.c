/* A file of tokens, and the look-up of a token that it does not have. */
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "server/net/tokens.h"
#include "tests/fuzz/fuzz.h"

void fuzz_one(const uint8_t *bytes, size_t size)
{
    char path[64];
    int fd = memfd_create("tokens", MFD_CLOEXEC);
    if (fd < 0)
        return;
    snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
    if (write(fd, bytes, size) == (ssize_t)size) {
        struct error error = {0};
        struct tokens *tokens = tokens_read(path, &error);
        MUST(tokens || (error.kind != ERROR_NONE && error.text[0]));
        if (tokens)
            MUST(!tokens_find(tokens, "nobody's token, which is long enough to be one"));
        tokens_destroy(tokens);
    }
    close(fd);
}
