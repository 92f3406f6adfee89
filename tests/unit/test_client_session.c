/* libsheen with servers that send a wrong greeting, refuse, or take uploads. */
#include <stdlib.h>
#include <string.h>

#include "tests/unit/fake_server.h"

/* ---- handshakes ---- */

static void serve_wrong_magic(int fd)
{
    read_message(fd, NULL, 0);
    send_bytes(fd, "HTTP/1.1 400 Bad Request\r\n\r\n", 28);
}

static void serve_wrong_version(int fd)
{
    uint8_t bytes[MESSAGE_HEADER_BYTES];
    read_message(fd, NULL, 0);
    message_header_encode(&(struct message_header){2, MESSAGE_ERROR, 0, 0, 1}, bytes);
    send_bytes(fd, bytes, sizeof(bytes));
}

static void serve_2_gb(int fd)
{
    read_message(fd, NULL, 0);
    send_header(fd, MESSAGE_HELLO_OK, 0, 0x80000000u, 1);
}

static void serve_unknown_type(int fd)
{
    read_message(fd, NULL, 0);
    send_header(fd, 99, 0, 0, 1);
}

static void serve_other_answer(int fd)
{
    read_message(fd, NULL, 0);
    send_message(fd, MESSAGE_UPLOAD_STATE, 1, &(sheen_UploadState){0});
}

static void serve_other_number(int fd)
{
    read_message(fd, NULL, 0);
    send_message(fd, MESSAGE_HELLO_OK, 77, &HELLO_OK);
}

static void serve_garbage_body(int fd)
{
    read_message(fd, NULL, 0);
    send_header(fd, MESSAGE_HELLO_OK, 0, 4, 1);
    send_bytes(fd, "\xff\xff\xff\xff", 4);
}

static void serve_terminal_escape(int fd)
{
    sheen_HelloOk ok = HELLO_OK;
    strcpy(ok.device, "\x1b]0;pwned\x07");
    read_message(fd, NULL, 0);
    send_message(fd, MESSAGE_HELLO_OK, 1, &ok);
}

static void serve_overloaded(int fd)
{
    read_message(fd, NULL, 0);
    send_error(fd, 0, sheen_ErrorCode_ERROR_OVERLOADED, "64 sessions are open: try later");
}

static void serve_nothing(int fd)
{
    (void)fd;
}

static void serve_half_a_header(int fd)
{
    read_message(fd, NULL, 0);
    send_bytes(fd, "SHEN\x01\x02", 6);
}

static void serve_silence(int fd)
{
    uint8_t byte;
    while (recv(fd, &byte, 1, 0) > 0)
        ;
}

static void bad_handshakes(void **state)
{
    (void)state;
    connect_ends_with(serve_wrong_magic, SHEEN_BAD_PEER, "SHEN");
    connect_ends_with(serve_wrong_version, SHEEN_BAD_VERSION, "version 2");
    connect_ends_with(serve_2_gb, SHEEN_BAD_PEER, "longer than its type allows");
    connect_ends_with(serve_unknown_type, SHEEN_BAD_PEER, "unknown");
    connect_ends_with(serve_other_answer, SHEEN_BAD_PEER, "another answer");
    connect_ends_with(serve_other_number, SHEEN_BAD_PEER, "no request in flight");
    connect_ends_with(serve_garbage_body, SHEEN_BAD_PEER, "not well-formed");
    connect_ends_with(serve_terminal_escape, SHEEN_BAD_PEER, "device");
    connect_ends_with(serve_overloaded, SHEEN_OVERLOADED, "64 sessions");
    connect_ends_with(serve_nothing, SHEEN_LOST_SERVER, "lost server");
    connect_ends_with(serve_half_a_header, SHEEN_LOST_SERVER, "lost server");
}

static void a_silent_server_costs_its_time(void **state)
{
    (void)state;
    struct fake fake;
    struct sheen_error error;
    struct sheen_session *session;
    fake_start(&fake, serve_silence);
    struct sheen_connect_options options = {
        .size = sizeof(options), .address = fake.address, .timeout_ms = 100};
    assert_int_equal(sheen_connect(&session, &options, &error), SHEEN_TIMEOUT);
    assert_non_null(strstr(error.text, "0.1 s"));
    fake_finish(&fake);
    fake_start(&fake, serve_silence);
    options.address = fake.address;
    options.timeout_ms = 0;
    options.connect_timeout_ms = 200;
    assert_int_equal(sheen_connect(&session, &options, &error), SHEEN_TIMEOUT);
    assert_non_null(strstr(error.text, "0.2 s"));
    fake_finish(&fake);
}

static void serve_greeting_alone(int fd)
{
    greet(fd);
    serve_silence(fd);
}

/* The time limit for connecting ends with the greeting. */
static void a_server_that_has_greeted_has_more_time(void **state)
{
    (void)state;
    struct fake fake;
    struct sheen_error error;
    struct sheen_session *session;
    struct sheen_stats stats = SHEEN_STATS_DEFAULTS;
    fake_start(&fake, serve_greeting_alone);
    struct sheen_connect_options options = {.size = sizeof(options),
                                            .address = fake.address,
                                            .timeout_ms = 300,
                                            .connect_timeout_ms = 2000};
    assert_int_equal(sheen_connect(&session, &options, &error), SHEEN_OK);
    assert_int_equal(sheen_query_stats(session, &stats, &error), SHEEN_TIMEOUT);
    assert_non_null(strstr(error.text, "0.3 s"));
    sheen_close(session);
    fake_finish(&fake);
}

static void nobody_listens(void **state)
{
    (void)state;
    struct sheen_error error;
    struct sheen_session *session;
    struct sheen_connect_options options = {.size = sizeof(options),
                                            .address = "unix:/tmp/sheen-no-such-socket"};
    assert_int_equal(sheen_connect(&session, &options, &error), SHEEN_NO_SERVER);
    assert_non_null(strstr(error.text, "/tmp/sheen-no-such-socket"));
    assert_int_equal(sheen_status_exit_code(SHEEN_NO_SERVER), 4);
    options.address = "tcp:127.0.0.1:1";
    assert_int_equal(sheen_connect(&session, &options, &error), SHEEN_NO_SERVER);
    options.address = "tcp:127.0.0.1:0";
    assert_int_equal(sheen_connect(&session, &options, &error), SHEEN_BAD_ARGUMENT);
    options.address = "nonsense";
    assert_int_equal(sheen_connect(&session, &options, &error), SHEEN_BAD_ARGUMENT);
    options.address = "unix:/tmp/x";
    options.device = "software";
    assert_int_equal(sheen_connect(&session, &options, &error), SHEEN_BAD_ARGUMENT);
    assert_int_equal(sheen_connect(NULL, &options, &error), SHEEN_BAD_ARGUMENT);
    assert_int_equal(sheen_connect(&session, NULL, NULL), SHEEN_BAD_ARGUMENT);
}

/* ---- uploads ---- */

#define FILE_BYTES 600000
#define KEPT_BYTES 100000

/* Reports KEPT_BYTES of an interrupted upload as kept, reads the rest, and compares it with the
 * file. */
static void serve_resume(int fd)
{
    static uint8_t chunk[PROTOCOL_MAX_CHUNK_BYTES];
    greet(fd);
    uint32_t seq = read_message(fd, NULL, 0).seq;
    sheen_UploadState reply = {.received_bytes = KEPT_BYTES};
    send_message(fd, MESSAGE_UPLOAD_STATE, seq, &reply);
    size_t received = KEPT_BYTES;
    bool same = true;
    while (received < FILE_BYTES) {
        struct message_header header = read_message(fd, chunk, sizeof(chunk));
        if (header.type != MESSAGE_UPLOAD_CHUNK || header.seq != seq)
            return;
        for (uint32_t i = 0; i < header.length; i++)
            same &= chunk[i] == (uint8_t)((received + i) / 7);
        received += header.length;
    }
    reply = (sheen_UploadState){.complete = same, .received_bytes = received};
    send_message(fd, MESSAGE_UPLOAD_STATE, seq, &reply);
    seq = read_message(fd, NULL, 0).seq;
    send_message(fd, MESSAGE_UPLOAD_STATE, seq, &reply); /* the daemon has the file by now */
}

static void last_done(void *context, const char *stage, uint64_t done, uint64_t total)
{
    assert_string_equal(stage, "upload");
    assert_int_equal(total, FILE_BYTES);
    *(uint64_t *)context = done;
}

static void an_upload_goes_on_where_it_broke(void **state)
{
    (void)state;
    struct fake fake;
    struct sheen_error error;
    struct sheen_session *session;
    uint8_t id[SHEEN_ID_BYTES], *bytes = malloc(FILE_BYTES);
    uint64_t done = 0;
    const struct sheen_progress progress = {last_done, &done};
    for (size_t i = 0; i < FILE_BYTES; i++)
        bytes[i] = (uint8_t)(i / 7);
    assert_true(sheen_file_id(bytes, FILE_BYTES, id));
    assert_int_equal(open_session(&fake, serve_resume, &session, &error), SHEEN_OK);
    for (int i = 0; i < 2; i++)
        assert_int_equal(sheen_upload(session, SHEEN_FILE_MODEL, id, bytes, FILE_BYTES,
                                      "/a/b/hood.obj", &progress, &error),
                         SHEEN_OK);
    assert_int_equal(done, FILE_BYTES);
    sheen_close(session);
    fake_finish(&fake);
    free(bytes);
}

static void serve_names(int fd)
{
    static uint8_t body[PROTOCOL_MAX_SMALL_BODY_BYTES];
    greet(fd);
    for (;;) {
        struct message_header header = read_message(fd, body, sizeof(body));
        sheen_UploadBegin begin;
        if (header.seq == 0)
            return;
        if (!message_decode(MESSAGE_UPLOAD_BEGIN, body, header.length, &begin))
            return;
        send_error(fd, header.seq, sheen_ErrorCode_ERROR_MODEL, begin.name);
    }
}

static void names_lose_folders_and_control_characters(void **state)
{
    (void)state;
    char long_name[400];
    memset(long_name, 'n', sizeof(long_name));
    strcpy(long_name + 390, ".obj");
    const char *const names[][2] = {{"/x/y/hood.obj", "hood.obj"},
                                    {"Kotfl\xc3\xbcgel.obj", "Kotfl\xc3\xbcgel.obj"},
                                    {"a\x1b[2J.obj", "a?[2J.obj"},
                                    {"latin\xfc.obj", "latin?.obj"},
                                    {long_name, long_name + 394 - 255}};
    struct fake fake;
    struct sheen_error error;
    struct sheen_session *session;
    uint8_t id[SHEEN_ID_BYTES] = {0};
    assert_int_equal(open_session(&fake, serve_names, &session, &error), SHEEN_OK);
    for (size_t i = 0; i < sizeof(names) / sizeof(*names); i++) {
        assert_int_equal(
            sheen_upload(session, SHEEN_FILE_MODEL, id, "v", 1, names[i][0], NULL, &error),
            SHEEN_BAD_MODEL);
        assert_string_equal(error.text, names[i][1]);
    }
    assert_int_equal(sheen_upload(session, SHEEN_FILE_MODEL, id, "v", 0, "a", NULL, &error),
                     SHEEN_BAD_ARGUMENT);
    assert_int_equal(sheen_upload(session, SHEEN_FILE_MODEL, id, "v", 1000001, "a", NULL, &error),
                     SHEEN_TOO_BIG);
    assert_int_equal(sheen_upload(session, SHEEN_FILE_MODEL, id, NULL, 1, "a", NULL, &error),
                     SHEEN_BAD_ARGUMENT);
    sheen_close(session);
    fake_finish(&fake);
}

/* Refuses an upload in its middle and closes the connection. The client must still report the
 * refusal's text. */
static void serve_refusal(int fd)
{
    greet(fd);
    uint32_t seq = read_message(fd, NULL, 0).seq;
    send_message(fd, MESSAGE_UPLOAD_STATE, seq, &(sheen_UploadState){0});
    read_message(fd, NULL, 0);
    send_error(fd, seq, sheen_ErrorCode_ERROR_SHUTTING_DOWN, "sheend is shutting down");
}

static void last_words_are_heard(void **state)
{
    (void)state;
    struct fake fake;
    struct sheen_error error;
    struct sheen_session *session;
    uint8_t id[SHEEN_ID_BYTES] = {0}, *bytes = calloc(1, 1000000);
    assert_int_equal(open_session(&fake, serve_refusal, &session, &error), SHEEN_OK);
    assert_int_equal(
        sheen_upload(session, SHEEN_FILE_MODEL, id, bytes, 1000000, "a.obj", NULL, &error),
        SHEEN_SHUTTING_DOWN);
    assert_string_equal(error.text, "sheend is shutting down");
    sheen_close(session);
    fake_finish(&fake);
    free(bytes);
}

/* ---- what is told of a model ---- */

static const uint32_t KINDS[] = {
    0, SHEEN_FINDING_OTHER - 1, SHEEN_FINDING_OTHER, 0x7fffffff, 0x80000000, 0xffffffff};
#define N_KINDS (sizeof(KINDS) / sizeof(*KINDS))

static void serve_kinds(int fd)
{
    static sheen_ModelInfo info;
    greet(fd);
    uint32_t seq = read_message(fd, NULL, 0).seq;
    info.findings_count = N_KINDS;
    for (size_t i = 0; i < N_KINDS; i++)
        info.findings[i] = (sheen_Finding){.kind = (sheen_FindingKind)KINDS[i], .count = 1};
    send_message(fd, MESSAGE_MODEL_INFO, seq, &info);
}

static void kinds_of_later_servers_are_other(void **state)
{
    (void)state;
    struct fake fake;
    struct sheen_error error;
    struct sheen_session *session;
    struct sheen_model_info info = SHEEN_MODEL_INFO_DEFAULTS;
    uint8_t id[SHEEN_ID_BYTES] = {0};
    assert_int_equal(open_session(&fake, serve_kinds, &session, &error), SHEEN_OK);
    assert_int_equal(sheen_query_model(session, id, NULL, &info, &error), SHEEN_OK);
    assert_int_equal(info.n_findings, N_KINDS);
    for (size_t i = 0; i < N_KINDS; i++)
        assert_int_equal(info.findings[i].kind,
                         KINDS[i] < SHEEN_FINDING_OTHER ? KINDS[i] : SHEEN_FINDING_OTHER);
    sheen_close(session);
    fake_finish(&fake);
}

static void sha256_of_abc(void **state)
{
    (void)state;
    static const uint8_t expected[4] = {0xba, 0x78, 0x16, 0xbf};
    uint8_t id[SHEEN_ID_BYTES];
    assert_true(sheen_file_id("abc", 3, id));
    assert_memory_equal(id, expected, sizeof(expected));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bad_handshakes),
        cmocka_unit_test(a_silent_server_costs_its_time),
        cmocka_unit_test(a_server_that_has_greeted_has_more_time),
        cmocka_unit_test(nobody_listens),
        cmocka_unit_test(an_upload_goes_on_where_it_broke),
        cmocka_unit_test(names_lose_folders_and_control_characters),
        cmocka_unit_test(last_words_are_heard),
        cmocka_unit_test(kinds_of_later_servers_are_other),
        cmocka_unit_test(sha256_of_abc),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
