#include "protocol/address.h"

#include <stdio.h>
#include <string.h>

static bool is_plain(const char *text)
{
    for (const unsigned char *c = (const unsigned char *)text; *c; c++)
        if (*c < 0x20 || *c == 0x7f)
            return false;
    return true;
}

static bool refuse(const char *text, const char *why, char *error_text)
{
    snprintf(error_text, ADDRESS_TEXT_BYTES,
             "address '%.300s' %s; write unix:PATH, tcp:HOST:PORT or tls:HOST:PORT",
             is_plain(text) ? text : "?", why);
    return false;
}

static bool parse_port(const char *text, uint16_t *port)
{
    size_t length = strlen(text);
    if (length == 0 || length > 5)
        return false;
    unsigned value = 0;
    for (size_t i = 0; i < length; i++) {
        if (text[i] < '0' || text[i] > '9')
            return false;
        value = value * 10 + (unsigned)(text[i] - '0');
    }
    if (value > UINT16_MAX)
        return false;
    *port = (uint16_t)value;
    return true;
}

static bool is_host_char(char c, bool bracketed)
{
    if ((c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.')
        return true;
    return bracketed ? c == ':' || c == '%' : c == '-' || c == '_';
}

static bool parse_tcp(struct address *address, const char *text, const char *rest, char *error_text)
{
    bool bracketed = rest[0] == '[';
    const char *host = rest + bracketed;
    const char *end = bracketed ? strchr(host, ']') : strrchr(host, ':');
    if (!end)
        return refuse(text, bracketed ? "has no closing ]" : "has no port", error_text);
    const char *colon = bracketed ? end + 1 : end;
    if (*colon != ':')
        return refuse(text, "has no port", error_text);
    size_t length = (size_t)(end - host);
    if (length == 0)
        return refuse(text, "has no host", error_text);
    if (length >= sizeof(address->host))
        return refuse(text, "has a host name over 253 bytes", error_text);
    for (size_t i = 0; i < length; i++)
        if (!is_host_char(host[i], bracketed))
            return refuse(text,
                          !bracketed && host[i] == ':' ? "has an IPv6 address without [brackets]"
                                                       : "has a character no host has",
                          error_text);
    if (!parse_port(colon + 1, &address->port))
        return refuse(text, "has a port that is not 0 to 65535", error_text);
    memcpy(address->host, host, length);
    return true;
}

bool address_parse(struct address *address, const char *text,
                   char error_text[static ADDRESS_TEXT_BYTES])
{
    memset(address, 0, sizeof(*address));
    bool tls = strncmp(text, "tls:", 4) == 0;
    if (tls || strncmp(text, "tcp:", 4) == 0) {
        address->kind = tls ? ADDRESS_TLS : ADDRESS_TCP;
        return parse_tcp(address, text, text + 4, error_text);
    }
    if (strncmp(text, "unix:", 5) != 0)
        return refuse(text, "begins with none of unix:, tcp: and tls:", error_text);
    address->kind = ADDRESS_UNIX;
    const char *path = text + 5;
    size_t length = strlen(path);
    if (length == 0)
        return refuse(text, "has no path", error_text);
    if (length >= sizeof(address->path))
        return refuse(text, "has a path over 107 bytes, the most a Unix socket takes", error_text);
    if (!is_plain(path))
        return refuse(text, "has a control character in its path", error_text);
    memcpy(address->path, path, length);
    return true;
}

const char *address_scheme(enum address_kind kind)
{
    return kind == ADDRESS_UNIX ? "unix" : kind == ADDRESS_TCP ? "tcp" : "tls";
}
