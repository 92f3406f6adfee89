/* A configuration file of sheend, and the command line that names it. */
#include <netdb.h>
#include <stdio.h>
#include <sys/mman.h>
#include <unistd.h>

#include "server/ops/options.h"
#include "tests/fuzz/fuzz.h"

/* Host names are resolved while options are checked. A wrapper answers, so that no input reaches
 * the network. */
int __wrap_getaddrinfo(const char *node, const char *service, const struct addrinfo *hints,
                       struct addrinfo **found);
int __wrap_getaddrinfo(const char *node, const char *service, const struct addrinfo *hints,
                       struct addrinfo **found)
{
    (void)node;
    (void)service;
    (void)hints;
    *found = NULL;
    return EAI_NONAME;
}

void fuzz_one(const uint8_t *bytes, size_t size)
{
    char path[64];
    int fd = memfd_create("config", MFD_CLOEXEC);
    if (fd < 0)
        return;
    snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
    if (write(fd, bytes, size) == (ssize_t)size) {
        char name[] = "sheend", option[] = "--config";
        char *arguments[] = {name, option, path, NULL};
        struct settings settings = {0};
        struct error error = {0};
        enum options_result result = options_read(3, arguments, &settings, &error);
        MUST(result == OPTIONS_SERVE || result == OPTIONS_CHECK || result == OPTIONS_WRONG);
        MUST((result == OPTIONS_WRONG) == (error.kind != ERROR_NONE));
        MUST(result != OPTIONS_WRONG || error.text[0]);
    }
    close(fd);
}
