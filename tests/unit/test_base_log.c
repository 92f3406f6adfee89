/* Lines of the log: no value can end a line or forge a field, and no client can fill the disk. */
#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "server/base/log.h"

static char said[1 << 20];

/* Runs write() with standard error redirected to a file, whose text is left in `said`. */
static void capture(void (*write_lines)(void))
{
    FILE *file = tmpfile();
    int old = dup(STDERR_FILENO);
    assert_non_null(file);
    assert_true(old >= 0 && dup2(fileno(file), STDERR_FILENO) >= 0);
    write_lines();
    dup2(old, STDERR_FILENO);
    close(old);
    rewind(file);
    said[fread(said, 1, sizeof said - 1, file)] = 0;
    fclose(file);
}

static unsigned count(char c)
{
    unsigned n = 0;
    for (const char *at = said; *at; at++)
        n += *at == c;
    return n;
}

static void assert_ends(const char *end)
{
    size_t length = strlen(said), n = strlen(end);
    assert_true(length >= n);
    assert_string_equal(said + length - n, end);
}

static void say_hostile(void)
{
    log_event(LOG_WARN, "it said", log_number("session", 7),
              log_text("text", "a b\nts=now level=info \"x\\y\" \x1b[2J"), log_text("empty", ""),
              log_text("plain", "unix:/tmp/a-b_c.sock"), log_text("utf8", "K\xc3\xbcgel \xff\xc0"));
}

static void test_logfmt(void **state)
{
    (void)state;
    log_set(LOG_INFO, LOG_LOGFMT);
    capture(say_hostile);
    assert_int_equal(count('\n'), 1);
    assert_memory_equal(said, "ts=20", 5);
    assert_ends("Z level=warn msg=\"it said\" session=7 text=\"a b\\u000ats=now level=info "
                "\\\"x\\\\y\\\" \\u001b[2J\" empty=\"\" plain=unix:/tmp/a-b_c.sock "
                "utf8=\"K\xc3\xbcgel ?\?\"\n");
}

static void test_json(void **state)
{
    (void)state;
    log_set(LOG_INFO, LOG_JSON);
    capture(say_hostile);
    assert_int_equal(count('\n'), 1);
    assert_memory_equal(said, "{\"ts\":\"20", 9);
    assert_ends(
        "Z\",\"level\":\"warn\",\"msg\":\"it said\",\"session\":7,\"text\":\"a b\\u000ats=now "
        "level=info \\\"x\\\\y\\\" \\u001b[2J\",\"empty\":\"\",\"plain\":\"unix:/tmp/a-b_c."
        "sock\",\"utf8\":\"K\xc3\xbcgel ?\?\"}\n");
}

static void say_long(void)
{
    static char text[100000];
    memset(text, '\a', sizeof text - 1);
    log_event(LOG_ERROR, "long", log_text("a", text), log_text("b", text), log_text("c", text),
              log_text("d", text), log_number("e", 5));
}

static void test_long_values_are_cut(void **state)
{
    (void)state;
    log_set(LOG_INFO, LOG_JSON);
    capture(say_long);
    assert_int_equal(count('\a'), 0);
    assert_int_equal(count('\\'), 4 * LOG_VALUE_BYTES);
    assert_ends("\\u0007\",\"e\":5}\n");
}

static void say_levels(void)
{
    log_event(LOG_DEBUG, "one", log_number("n", 1));
    log_event(LOG_INFO, "two", log_number("n", 2));
    log_event(LOG_WARN, "three", log_number("n", 3));
    log_event(LOG_ERROR, "four", log_number("n", 4));
}

static void test_levels(void **state)
{
    (void)state;
    for (unsigned level = LOG_ERROR; level <= LOG_DEBUG; level++) {
        log_set(level, LOG_LOGFMT);
        capture(say_levels);
        assert_int_equal(count('\n'), level - LOG_ERROR + 1);
    }
}

static void flood(void)
{
    for (unsigned i = 0; i < 3 * LOG_LINES_PER_S; i++)
        log_event(LOG_INFO, "flood", log_number("i", i));
    log_event(LOG_ERROR, "no flood hides this", log_number("i", 0));
    log_event(LOG_WARN, "nor this", log_number("i", 0));
    usleep(1050000);
    log_event(LOG_INFO, "after", log_number("i", 0));
}

static void test_floods_are_cut_and_counted(void **state)
{
    (void)state;
    char words[64];
    usleep(1050000); /* waits until the limit of lines for a new second applies */
    log_set(LOG_INFO, LOG_LOGFMT);
    capture(flood);
    assert_int_equal(log_left_out(), 2 * LOG_LINES_PER_S);
    assert_int_equal(count('\n'), LOG_LINES_PER_S + 4);
    snprintf(words, sizeof words, "msg=\"log lines were left out\" count=%d\n",
             2 * LOG_LINES_PER_S);
    assert_non_null(strstr(said, words));
    assert_non_null(strstr(said, "no flood hides this"));
    assert_non_null(strstr(said, "nor this"));
    assert_ends("msg=after i=0\n");
}

static void test_a_reader_that_stops(void **state)
{
    (void)state;
    int pipe_fds[2], old = dup(STDERR_FILENO);
    char words[64];
    assert_int_equal(pipe(pipe_fds), 0);
    assert_true(fcntl(pipe_fds[1], F_SETPIPE_SZ, 4096) > 0);
    log_set(LOG_INFO, LOG_LOGFMT);
    usleep(1050000);
    uint64_t before = log_left_out();
    dup2(pipe_fds[1], STDERR_FILENO);
    /* a write that blocked would wait for ever, since the pipe is full */
    for (unsigned i = 0; i < 1000; i++)
        log_event(LOG_ERROR, "to nobody", log_number("i", i));
    uint64_t left_out = log_left_out() - before;
    assert_true(left_out > 800);
    /* Once the pipe is read again, a line tells how many lines were left out. */
    said[read(pipe_fds[0], said, sizeof said - 1)] = 0;
    assert_int_equal(count('\n') + left_out, 1000);
    usleep(1050000);
    log_event(LOG_INFO, "after", log_number("i", 0));
    dup2(old, STDERR_FILENO);
    said[read(pipe_fds[0], said, sizeof said - 1)] = 0;
    snprintf(words, sizeof words, "left out\" count=%u\n", (unsigned)left_out);
    assert_non_null(strstr(said, words));
    for (int i = 0; i < 2; i++)
        close(pipe_fds[i]);
    close(old);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_logfmt),
        cmocka_unit_test(test_json),
        cmocka_unit_test(test_long_values_are_cut),
        cmocka_unit_test(test_levels),
        cmocka_unit_test(test_floods_are_cut_and_counted),
        cmocka_unit_test(test_a_reader_that_stops),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
