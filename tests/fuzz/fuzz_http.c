/* A request to the HTTP port of metrics and health. */
#include <string.h>

#include "server/net/http.h"
#include "tests/fuzz/fuzz.h"

void fuzz_one(const uint8_t *bytes, size_t size)
{
    char request[HTTP_MAX_REQUEST_BYTES + 1];
    const char *path = NULL;
    size_t length = size < HTTP_MAX_REQUEST_BYTES ? size : HTTP_MAX_REQUEST_BYTES;
    memcpy(request, bytes, length);
    request[length] = 0;
    int status = http_parse(request, length, &path);
    MUST(status == 0 || status == 200 || status == 400 || status == 405 || status == 431);
    MUST(status != 0 || length < HTTP_MAX_REQUEST_BYTES);
    if (status == 200) {
        MUST(path > request && path < request + length && *path == '/');
        MUST(path[strcspn(path, " ?\r\n")] == 0 && path + strlen(path) < request + length);
        MUST(strcmp(request, "GET") == 0);
    }
}
