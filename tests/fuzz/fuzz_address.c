/* The text of an address. */
#include <stdlib.h>
#include <string.h>

#include "protocol/address.h"
#include "protocol/messages/message.h"
#include "tests/fuzz/fuzz.h"

void fuzz_one(const uint8_t *bytes, size_t size)
{
    struct address address;
    char wrong[ADDRESS_TEXT_BYTES] = "";
    char *text = malloc(size + 1);
    if (!text)
        return;
    memcpy(text, bytes, size);
    text[size] = 0;
    if (!address_parse(&address, text, wrong))
        MUST(wrong[0]);
    else if (address.kind == ADDRESS_UNIX)
        MUST(address.path[0] && strlen(address.path) < sizeof address.path);
    else
        MUST(address.host[0] && strlen(address.host) < sizeof address.host);
    message_is_text(text, true);
    free(text);
}
