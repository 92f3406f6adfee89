/* Maps of user namespaces: valid ones, as the kernel writes them, and invalid ones. */
#include "server/net/user_namespace.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

struct file {
    char path[32];
};

static struct file file_of(const char *text)
{
    struct file file = {"/tmp/sheen-id-map-XXXXXX"};
    int fd = mkstemp(file.path);
    assert_true(fd >= 0);
    assert_int_equal(write(fd, text, strlen(text)), strlen(text));
    close(fd);
    return file;
}

static struct user_namespace read_texts(const char *map_text, const char *overflow_text)
{
    struct file map = file_of(map_text), overflow = file_of(overflow_text);
    struct user_namespace found = user_namespace_read(map.path, overflow.path);
    unlink(map.path);
    unlink(overflow.path);
    return found;
}

static void only_a_map_of_all_ids_is_whole(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        bool is_whole;
    } cases[] = {
        {"         0          0 4294967295\n", true},
        {"         0          0 4294967295", true},
        {"0 0 1000\n1000 5000 4000\n5000 1000 4000\n9000 9000 4294958295\n", true},
        {"", false}, /* the map that unshare --user makes */
        {"         0       1000          1\n", false},
        {"      1000       1000          1\n         0          0          1\n", false},
        {"         0     100000      65536\n", false},
        {"         0          0 4294967294\n", false},
        {"         0          0 4294967295\n 1 1 1\n", false},
        {"         0          0 4294967295\nx", false},
        {"         0          0 99999999999\n", false},
        {"         0          0         -1\n", false},
        {"4294967295\n", false},
        {"all of them\n", false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        if (read_texts(cases[i].text, "65534\n").is_whole != cases[i].is_whole)
            fail_msg("'%s' is taken wrong", cases[i].text);
}

static void the_overflow_id_is_the_kernels(void **state)
{
    (void)state;
    assert_int_equal(read_texts("", "65533\n").overflow, 65533);
    assert_int_equal(read_texts("", "0").overflow, 0);
    static const char *const bad[] = {"", "x\n", "4294967296\n", "-1\n"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(read_texts("", bad[i]).overflow, 65534);
}

static void files_may_be_missing(void **state)
{
    (void)state;
    struct user_namespace map =
        user_namespace_read("/proc/self/no_map", "/proc/sys/kernel/no_overflow");
    assert_false(map.is_whole);
    assert_int_equal(map.overflow, 65534);
}

static void one_id_is_hidden_where_the_map_has_gaps(void **state)
{
    (void)state;
    const struct user_namespace part = {false, 65534}, whole = {true, 65534};
    assert_true(user_namespace_hides(&part, 65534));
    assert_false(user_namespace_hides(&part, 0));
    assert_false(user_namespace_hides(&part, 65533));
    assert_false(user_namespace_hides(&whole, 65534));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(only_a_map_of_all_ids_is_whole),
        cmocka_unit_test(the_overflow_id_is_the_kernels),
        cmocka_unit_test(files_may_be_missing),
        cmocka_unit_test(one_id_is_hidden_where_the_map_has_gaps),
    };
    return cmocka_run_group_tests_name("user_namespace", tests, NULL, NULL);
}
