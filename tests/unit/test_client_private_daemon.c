/* How a private daemon starts, works and ends; shell scripts play the daemon. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "client/lib/connection.h"
#include "client/lib/machine_memory.h"
#include "client/lib/private_daemon.h"
#include "client/lib/sheen.h"
#include "tests/unit/file_tree.h"

static char folder[64], script_path[96], report_path[96];

/* Writes `text` as the script that plays the daemon. */
static void play(const char *text)
{
    FILE *file = fopen(script_path, "w");
    assert_non_null(file);
    fprintf(file, "#!/bin/sh\n%s\n", text);
    fclose(file);
    assert_int_equal(chmod(script_path, 0700), 0);
    setenv("SHEEN_DAEMON", script_path, 1);
}

static int setup(void **state)
{
    (void)state;
    strcpy(folder, "/tmp/sheen-test-XXXXXX");
    if (!mkdtemp(folder))
        return -1;
    snprintf(script_path, sizeof(script_path), "%s/sheend", folder);
    snprintf(report_path, sizeof(report_path), "%s/report", folder);
    return 0;
}

static int teardown(void **state)
{
    (void)state;
    unlink(script_path);
    unlink(report_path);
    return rmdir(folder);
}

static void no_child_is_left(void)
{
    errno = 0;
    assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
    assert_int_equal(errno, ECHILD);
}

static void connect_ends_with(enum sheen_status status, const char *text)
{
    struct sheen_error error = {0};
    struct sheen_session *session;
    struct sheen_connect_options options = SHEEN_CONNECT_DEFAULTS;
    assert_int_equal(sheen_connect(&session, &options, &error), status);
    assert_null(session);
    assert_ptr_equal(strstr(error.text, text), error.text);
    assert_null(strchr(error.text, '\n'));
    no_child_is_left();
}

static void a_daemon_without_a_device(void **state)
{
    (void)state;
    play("echo 'first line' >&2; echo 'sheend: no EGL device: none was found' >&2; exit 5");
    connect_ends_with(SHEEN_DEVICE_FAILED, "no EGL device: none was found");
    assert_int_equal(sheen_status_exit_code(SHEEN_DEVICE_FAILED), 5);
}

static void a_daemon_that_dies_at_start(void **state)
{
    (void)state;
    play("echo 'sheend: out of luck' >&2; echo >&2; exit 1");
    connect_ends_with(SHEEN_LOST_SERVER, "out of luck");
    play("exit 7");
    connect_ends_with(SHEEN_LOST_SERVER, "the private daemon ended with exit code 7");
    play("exit 0");
    connect_ends_with(SHEEN_LOST_SERVER, "the private daemon ended with exit code 0");
    play("kill -9 $$");
    connect_ends_with(SHEEN_LOST_SERVER, "the private daemon died of signal 9");
    play("printf 'control \\033[2J\\n' >&2; exit 1");
    connect_ends_with(SHEEN_LOST_SERVER, "control ?[2J");
    /* Of more output than is kept, the error text has the end. */
    play("i=0; while [ $i -lt 300 ]; do echo xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx >&2; "
         "i=$((i+1)); done; echo 'the last line' >&2; exit 1");
    connect_ends_with(SHEEN_LOST_SERVER, "the last line");
}

static void a_daemon_that_cannot_be_started(void **state)
{
    (void)state;
    setenv("SHEEN_DAEMON", "/no/such/sheend", 1);
    connect_ends_with(SHEEN_NO_SERVER, "cannot start a private daemon (/no/such/sheend)");
    assert_int_equal(sheen_status_exit_code(SHEEN_NO_SERVER), 4);
}

static void a_daemon_that_speaks_nonsense(void **state)
{
    (void)state;
    play("echo 'hello, this is no sheend at all' >&3; cat <&3 >/dev/null");
    connect_ends_with(SHEEN_BAD_PEER, "the server broke the protocol");
}

/* Reads what the script has written to the report. */
static void read_report(char *text, size_t size)
{
    FILE *file = fopen(report_path, "r");
    assert_non_null(file);
    size_t n = fread(text, 1, size - 1, file);
    text[n] = 0;
    fclose(file);
}

static void arguments_and_files(void **state)
{
    (void)state;
    char script[400], report[400];
    /* The report: the arguments, then the numbers of the open files, among them one of ls
     * itself. */
    snprintf(script, sizeof(script),
             "echo \"$*\" > %s; ls /proc/self/fd | tr '\\n' ' ' >> %s; exit 1", report_path,
             report_path);
    /* not close-on-exec, as in a program that does not care */
    int leaked = open("/dev/null", O_RDONLY);
    assert_true(leaked >= 3);
    int far = fcntl(leaked, F_DUPFD, 200);
    play(script);
    struct sheen_error error;
    struct sheen_session *session;
    struct sheen_connect_options options = SHEEN_CONNECT_DEFAULTS;
    options.device = "software";
    options.native_isa = "v2";
    options.native_threads = 64;
    options.memory_budget_bytes = 5000000;
    assert_int_equal(sheen_connect(&session, &options, &error), SHEEN_LOST_SERVER);
    read_report(report, sizeof(report));
    assert_string_equal(report,
                        "--session-fd 3 --device software --native-threads 64 --native-isa v2 "
                        "--memory-budget 5000000 --peer-memory 5000000\n0 1 2 3 4 ");
    options.device = options.native_isa = NULL;
    options.native_threads = 0;
    options.memory_budget_bytes = 0;
    assert_int_equal(sheen_connect(&session, &options, &error), SHEEN_LOST_SERVER);
    read_report(report, sizeof(report));
    char wanted[200];
    unsigned long long half = machine_memory_bytes("") / 2;
    assert_true(half > 100000000);
    snprintf(wanted, sizeof(wanted),
             "--session-fd 3 --memory-budget %llu --peer-memory %llu\n0 1 2 3 4 ", half, half);
    assert_string_equal(report, wanted);
    close(leaked);
    close(far);
    no_child_is_left();
}

static void put(const char *path, const char *text)
{
    put_below(folder, path, text);
}

static void remove_tree(void)
{
    char command[200];
    snprintf(command, sizeof(command), "rm -rf %s/proc %s/sys", folder, folder);
    assert_int_equal(system(command), 0);
}

/* The machine's memory, or the limit of a control group where that is less: of both versions of
 * control groups, and of all parent groups. */
static void memory_of_the_machine(void **state)
{
    (void)state;
    const uint64_t gib = (uint64_t)1 << 30;
    assert_int_equal(machine_memory_bytes(folder), 0);
    put("/proc/meminfo", "MemFree: 1 kB\nMemTotal:       16777216 kB\nMemAvailable: 2 kB\n");
    assert_int_equal(machine_memory_bytes(folder), 16 * gib);
    put("/proc/self/cgroup", "5:cpu,cpuacct:/x\n4:cpu,memory:/a/b\n0::/c/d\nnonsense\n");
    assert_int_equal(machine_memory_bytes(folder), 16 * gib);
    put("/sys/fs/cgroup/memory/a/memory.limit_in_bytes", "9223372036854771712\n");
    put("/sys/fs/cgroup/c/d/memory.max", "max\n");
    assert_int_equal(machine_memory_bytes(folder), 16 * gib);
    put("/sys/fs/cgroup/c/memory.max", "8589934592\n");
    assert_int_equal(machine_memory_bytes(folder), 8 * gib);
    put("/sys/fs/cgroup/memory/a/b/memory.limit_in_bytes", "4294967296\n");
    assert_int_equal(machine_memory_bytes(folder), 4 * gib);
    put("/sys/fs/cgroup/memory.max", "1073741824\n"); /* the root group as a container sees it */
    assert_int_equal(machine_memory_bytes(folder), gib);
    remove_tree();
}

static void the_daemon_ends_with_its_socket(void **state)
{
    (void)state;
    struct connection connection;
    struct private_daemon daemon;
    struct sheen_error error;
    int peer_fd;
    play("cat <&3 >/dev/null"); /* reads to the end of the stream */
    assert_int_equal(connection_pair(&connection, &peer_fd, 1000, &error), SHEEN_OK);
    const struct sheen_connect_options options = SHEEN_CONNECT_DEFAULTS;
    assert_int_equal(private_daemon_start(&daemon, peer_fd, &options, &error), SHEEN_OK);
    close(peer_fd);
    assert_int_equal(waitpid(daemon.pid, NULL, WNOHANG), 0);
    connection_finish(&connection);
    private_daemon_finish(&daemon);
    no_child_is_left();
    private_daemon_finish(&daemon); /* a second call does no harm */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_daemon_without_a_device),
        cmocka_unit_test(a_daemon_that_dies_at_start),
        cmocka_unit_test(a_daemon_that_cannot_be_started),
        cmocka_unit_test(a_daemon_that_speaks_nonsense),
        cmocka_unit_test(arguments_and_files),
        cmocka_unit_test(memory_of_the_machine),
        cmocka_unit_test(the_daemon_ends_with_its_socket),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
