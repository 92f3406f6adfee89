/* Headers of messages, and addresses. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
#include <string.h>

#include "protocol/address.h"
#include "protocol/frame.h"
#include "protocol/limits.h"

static void encode(uint8_t bytes[static 16], uint8_t type, uint32_t length)
{
    const struct message_header header = {PROTOCOL_MAJOR, type, MESSAGE_END, length, 0x01020304};
    message_header_encode(&header, bytes);
}

static void header_round_trip_is_little_endian(void **state)
{
    (void)state;
    static const uint8_t expected[16] = {'S', 'H',  'E',  'N', 1, 10, 1, 0,
                                         2,   0x01, 0x0f, 0,   4, 3,  2, 1};
    uint8_t bytes[16];
    struct message_header header;
    encode(bytes, MESSAGE_DATA, 0x0f0102);
    assert_memory_equal(bytes, expected, 16);
    assert_int_equal(message_header_decode(&header, bytes), HEADER_OK);
    assert_int_equal(header.major, 1);
    assert_int_equal(header.type, MESSAGE_DATA);
    assert_int_equal(header.flags, MESSAGE_END);
    assert_int_equal(header.length, 0x0f0102);
    assert_int_equal(header.seq, 0x01020304);
}

static void bad_headers_are_told_apart(void **state)
{
    (void)state;
    uint8_t bytes[16];
    struct message_header header;
    for (int i = 0; i < 4; i++) {
        encode(bytes, MESSAGE_HELLO, 40);
        bytes[i] ^= 0x20;
        assert_int_equal(message_header_decode(&header, bytes), HEADER_BAD_MAGIC);
    }
    encode(bytes, MESSAGE_HELLO, 40);
    bytes[4] = PROTOCOL_MAJOR + 1;
    assert_int_equal(message_header_decode(&header, bytes), HEADER_BAD_MAJOR);
    assert_int_equal(header.major, PROTOCOL_MAJOR + 1);
    static const uint8_t unknown[] = {0, MESSAGE_TYPES, 255};
    for (size_t i = 0; i < sizeof(unknown); i++) {
        encode(bytes, unknown[i], 0);
        assert_int_equal(message_header_decode(&header, bytes), HEADER_BAD_TYPE);
        assert_int_equal(message_max_length(unknown[i]), 0);
        assert_string_equal(message_type_name(unknown[i]), "unknown");
    }
}

static void lengths_are_bounded_by_type(void **state)
{
    (void)state;
    uint8_t bytes[16];
    struct message_header header;
    for (uint8_t type = MESSAGE_HELLO; type < MESSAGE_TYPES; type++) {
        uint32_t most = message_max_length(type);
        encode(bytes, type, most);
        assert_int_equal(message_header_decode(&header, bytes), HEADER_OK);
        encode(bytes, type, most + 1);
        assert_int_equal(message_header_decode(&header, bytes), HEADER_TOO_LONG);
        encode(bytes, type, 0x80000000u); /* 2 GB */
        assert_int_equal(message_header_decode(&header, bytes), HEADER_TOO_LONG);
        encode(bytes, type, UINT32_MAX);
        assert_int_equal(message_header_decode(&header, bytes), HEADER_TOO_LONG);
    }
    assert_int_equal(message_max_length(MESSAGE_UPLOAD_CHUNK), 256 * 1024);
    assert_int_equal(message_max_length(MESSAGE_DATA), 1024 * 1024);
    assert_int_equal(message_max_length(MESSAGE_STATS_QUERY), 0);
}

static void good_addresses(void **state)
{
    (void)state;
    struct address address;
    char text[ADDRESS_TEXT_BYTES];
    assert_true(address_parse(&address, "unix:/run/sheen/sheen.sock", text));
    assert_int_equal(address.kind, ADDRESS_UNIX);
    assert_string_equal(address.path, "/run/sheen/sheen.sock");
    assert_true(address_parse(&address, "unix:a:b", text));
    assert_string_equal(address.path, "a:b");
    static const struct {
        const char *text, *host;
        uint16_t port;
        enum address_kind kind;
    } tcp[] = {{"tcp:127.0.0.1:7410", "127.0.0.1", 7410, ADDRESS_TCP},
               {"tcp:render-1.example.org:65535", "render-1.example.org", 65535, ADDRESS_TCP},
               {"tcp:[::1]:1", "::1", 1, ADDRESS_TCP},
               {"tcp:[fe80::1%eth0]:80", "fe80::1%eth0", 80, ADDRESS_TCP},
               {"tcp:localhost:0", "localhost", 0, ADDRESS_TCP},
               {"tls:node7.example.org:7410", "node7.example.org", 7410, ADDRESS_TLS},
               {"tls:[::]:1", "::", 1, ADDRESS_TLS}};
    for (size_t i = 0; i < sizeof(tcp) / sizeof(*tcp); i++) {
        assert_true(address_parse(&address, tcp[i].text, text));
        assert_int_equal(address.kind, tcp[i].kind);
        assert_string_equal(address.host, tcp[i].host);
        assert_int_equal(address.port, tcp[i].port);
    }
}

static void bad_addresses_say_why(void **state)
{
    (void)state;
    static const struct {
        const char *text, *why;
    } bad[] = {{"", "none of"},
               {"/run/sheen/sheen.sock", "none of"},
               {"udp:host:1", "none of"},
               {"unix:", "no path"},
               {"unix:a\nb", "control character"},
               {"tcp:", "no port"},
               {"tcp:host", "no port"},
               {"tls:host", "no port"},
               {"tcp::80", "no host"},
               {"tcp:host:", "port that is not"},
               {"tcp:host:-1", "port that is not"},
               {"tcp:host:+1", "port that is not"},
               {"tcp:host:65536", "port that is not"},
               {"tcp:host:99999999999999999999", "port that is not"},
               {"tcp:host:8 0", "port that is not"},
               {"tcp:[::1:80", "closing"},
               {"tcp:[::1]80", "no port"},
               {"tcp:[]:80", "no host"},
               {"tcp:::1:80", "brackets"},
               {"tcp:ho st:80", "no host has"},
               {"tcp:user@host:80", "no host has"}};
    struct address address;
    for (size_t i = 0; i < sizeof(bad) / sizeof(*bad); i++) {
        char text[ADDRESS_TEXT_BYTES] = "";
        assert_false(address_parse(&address, bad[i].text, text));
        assert_non_null(strstr(text, bad[i].why));
        assert_null(strchr(text, '\n'));
    }
}

static void long_addresses_are_cut_by_nobody(void **state)
{
    (void)state;
    struct address address;
    char text[ADDRESS_TEXT_BYTES], path[2000] = "unix:", host[2000] = "tcp:";
    memset(path + 5, 'p', 107);
    assert_true(address_parse(&address, path, text));
    assert_int_equal(strlen(address.path), 107);
    path[5 + 107] = 'p';
    assert_false(address_parse(&address, path, text));
    memset(path + 5, 'p', 1900);
    assert_false(address_parse(&address, path, text));
    memset(host + 4, 'h', 253);
    strcpy(host + 4 + 253, ":80");
    assert_true(address_parse(&address, host, text));
    memset(host + 4, 'h', 254);
    strcpy(host + 4 + 254, ":80");
    assert_false(address_parse(&address, host, text));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(header_round_trip_is_little_endian),
        cmocka_unit_test(bad_headers_are_told_apart),
        cmocka_unit_test(lengths_are_bounded_by_type),
        cmocka_unit_test(good_addresses),
        cmocka_unit_test(bad_addresses_say_why),
        cmocka_unit_test(long_addresses_are_cut_by_nobody),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
