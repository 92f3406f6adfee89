/* Reads whole files; writes a whole file or none. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include "client/cli/files/file.h"
#include "client/lib/files/read_file.h"

static char folder[64];

static int setup(void **state)
{
    (void)state;
    strcpy(folder, "/tmp/sheen-test-XXXXXX");
    return mkdtemp(folder) ? chdir(folder) : -1;
}

static int teardown(void **state)
{
    (void)state;
    return chdir("/") == 0 ? rmdir(folder) : -1;
}

static int files_in_folder(void)
{
    int n = 0;
    DIR *list = opendir(".");
    assert_non_null(list);
    for (struct dirent *entry; (entry = readdir(list));)
        n += entry->d_name[0] != '.';
    closedir(list);
    return n;
}

static void assert_holds(const char *path, const char *text)
{
    struct sheen_error error;
    uint8_t *bytes = NULL;
    size_t n_bytes = 0;
    assert_int_equal(read_file(path, SHEEN_BAD_MODEL, &bytes, &n_bytes, &error), SHEEN_OK);
    assert_int_equal(n_bytes, strlen(text));
    assert_memory_equal(bytes, text, n_bytes);
    free(bytes);
}

static void written_files_replace_old_ones(void **state)
{
    (void)state;
    struct sheen_error error;
    struct stat about;
    mode_t old = umask(027);
    assert_int_equal(file_check_writable("a.png", &error), SHEEN_OK);
    assert_int_equal(file_write("a.png", (const uint8_t *)"first", 5, &error), SHEEN_OK);
    assert_holds("a.png", "first");
    assert_int_equal(file_check_writable("a.png", &error), SHEEN_OK);
    assert_int_equal(file_write("a.png", (const uint8_t *)"2nd", 3, &error), SHEEN_OK);
    assert_holds("a.png", "2nd");
    assert_int_equal(stat("a.png", &about), 0);
    /* the permissions of a new file follow the umask */
    assert_int_equal(about.st_mode & 0777, 0640);
    assert_int_equal(files_in_folder(), 1);
    umask(old);
    unlink("a.png");
}

static void a_stale_temporary_is_stepped_over(void **state)
{
    (void)state;
    struct sheen_error error;
    char stale[64];
    snprintf(stale, sizeof(stale), "a.png.%ld-0.tmp", (long)getpid());
    fclose(fopen(stale, "w"));
    assert_int_equal(file_write("a.png", (const uint8_t *)"x", 1, &error), SHEEN_OK);
    assert_holds("a.png", "x");
    assert_int_equal(files_in_folder(), 2);
    unlink(stale);
    unlink("a.png");
}

static void a_full_disk_leaves_what_was_there(void **state)
{
    (void)state;
    struct sheen_error error;
    struct rlimit limit, small;
    assert_int_equal(file_write("a.png", (const uint8_t *)"old", 3, &error), SHEEN_OK);
    uint8_t *large = calloc(1, 100000);
    signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &limit);
    small = limit;
    small.rlim_cur = 1000; /* writing fails in the middle of the file, as on a full disk */
    setrlimit(RLIMIT_FSIZE, &small);
    enum sheen_status status = file_write("a.png", large, 100000, &error);
    setrlimit(RLIMIT_FSIZE, &limit);
    assert_int_equal(status, SHEEN_BAD_IMAGE);
    assert_non_null(strstr(error.text, "a.png: cannot be written"));
    assert_holds("a.png", "old");
    assert_int_equal(files_in_folder(), 1);
    free(large);
    unlink("a.png");
}

static void places_that_take_no_file(void **state)
{
    (void)state;
    struct sheen_error error;
    assert_int_equal(file_check_writable("no/such/folder/a.png", &error), SHEEN_BAD_IMAGE);
    assert_non_null(strstr(error.text, "no/such/folder/a.png"));
    assert_int_equal(file_write("no/such/folder/a.png", (const uint8_t *)"x", 1, &error),
                     SHEEN_BAD_IMAGE);
    assert_int_equal(file_write("base.obj", (const uint8_t *)"x", 1, &error), SHEEN_OK);
    for (mode_t mode = 0600; mode <= 0700; mode += 0100) {
        assert_int_equal(chmod("base.obj", mode), 0);
        assert_int_equal(file_check_writable("base.obj/a.png", &error), SHEEN_BAD_IMAGE);
        assert_non_null(strstr(error.text, "base.obj/a.png: cannot be written: Not a directory"));
    }
    unlink("base.obj");
    assert_int_equal(mkdir("folder.png", 0700), 0);
    assert_int_equal(file_check_writable("folder.png", &error), SHEEN_BAD_IMAGE);
    assert_int_equal(file_write("folder.png", (const uint8_t *)"x", 1, &error), SHEEN_BAD_IMAGE);
    assert_int_equal(files_in_folder(), 1);
    rmdir("folder.png");
    assert_int_equal(file_check_writable("/dev/null", &error), SHEEN_BAD_IMAGE);
}

static void assert_links(const char *path, bool is_link)
{
    struct stat about;
    assert_int_equal(lstat(path, &about), 0);
    assert_int_equal(S_ISLNK(about.st_mode), is_link);
}

/* A link stays a link, and the file to which it leads is written, whether it exists or not. */
static void links_are_followed(void **state)
{
    (void)state;
    struct sheen_error error;
    assert_int_equal(mkdir("real", 0700), 0);
    assert_int_equal(file_write("real/a.png", (const uint8_t *)"old", 3, &error), SHEEN_OK);
    assert_int_equal(symlink("a.png", "real/b.png"), 0);
    assert_int_equal(symlink("real/b.png", "chain.png"), 0);
    assert_int_equal(symlink("../fresh.png", "real/dangling.png"), 0);
    assert_int_equal(symlink("real", "folder"), 0);
    assert_int_equal(symlink("loop.png", "loop.png"), 0);
    assert_int_equal(symlink("no/such/folder.png", "astray.png"), 0);
    assert_int_equal(file_check_writable("chain.png", &error), SHEEN_OK);
    assert_int_equal(file_write("chain.png", (const uint8_t *)"new", 3, &error), SHEEN_OK);
    assert_holds("real/a.png", "new");
    assert_links("chain.png", true);
    assert_links("real/b.png", true);
    assert_links("real/a.png", false);
    assert_int_equal(file_check_writable("folder/dangling.png", &error), SHEEN_OK);
    assert_int_equal(file_write("folder/dangling.png", (const uint8_t *)"abc", 3, &error),
                     SHEEN_OK);
    assert_links("folder/dangling.png", true);
    assert_links("fresh.png", false);
    assert_holds("fresh.png", "abc");
    static const char *const nowhere[] = {"loop.png", "astray.png"};
    for (size_t i = 0; i < sizeof nowhere / sizeof *nowhere; i++) {
        assert_int_equal(file_check_writable(nowhere[i], &error), SHEEN_BAD_IMAGE);
        assert_int_equal(file_write(nowhere[i], (const uint8_t *)"x", 1, &error), SHEEN_BAD_IMAGE);
        assert_links(nowhere[i], true);
        unlink(nowhere[i]);
    }
    assert_int_equal(files_in_folder(), 4); /* no temporary file is left */
    static const char *const made[] = {"fresh.png",  "folder",     "chain.png",
                                       "real/b.png", "real/a.png", "real/dangling.png"};
    for (size_t i = 0; i < sizeof made / sizeof *made; i++)
        unlink(made[i]);
    assert_int_equal(rmdir("real"), 0);
}

static void files_that_cannot_be_read(void **state)
{
    (void)state;
    struct sheen_error error;
    uint8_t *bytes = NULL;
    size_t n_bytes;
    assert_int_equal(read_file("none.obj", SHEEN_BAD_MODEL, &bytes, &n_bytes, &error),
                     SHEEN_BAD_MODEL);
    assert_non_null(strstr(error.text, "none.obj: No such file"));
    fclose(fopen("empty.obj", "w"));
    assert_int_equal(read_file("empty.obj", SHEEN_BAD_IMAGE, &bytes, &n_bytes, &error),
                     SHEEN_BAD_IMAGE);
    assert_non_null(strstr(error.text, "empty.obj: is empty"));
    /* a sparse file, which takes no space */
    assert_int_equal(truncate("empty.obj", 1024ll * 1024 * 1024 + 1), 0);
    assert_int_equal(read_file("empty.obj", SHEEN_BAD_MODEL, &bytes, &n_bytes, &error),
                     SHEEN_TOO_BIG);
    unlink("empty.obj");
    assert_int_equal(read_file(".", SHEEN_BAD_MODEL, &bytes, &n_bytes, &error), SHEEN_BAD_MODEL);
    assert_int_equal(mkfifo("pipe.obj", 0600), 0);
    assert_int_equal(read_file("pipe.obj", SHEEN_BAD_MODEL, &bytes, &n_bytes, &error),
                     SHEEN_BAD_MODEL); /* returns at once and does not wait */
    unlink("pipe.obj");
    assert_null(bytes);
}

static void links_are_refused_anywhere_in_a_path(void **state)
{
    (void)state;
    struct sheen_error error;
    uint8_t *bytes = NULL;
    size_t n_bytes = 0;
    assert_int_equal(mkdir("real", 0700), 0);
    assert_int_equal(file_write("real/a", (const uint8_t *)"abc", 3, &error), SHEEN_OK);
    assert_int_equal(symlink("a", "real/link"), 0);
    assert_int_equal(symlink("real", "folder"), 0);
    assert_int_equal(read_file_linkless("real/a", SHEEN_BAD_MODEL, &bytes, &n_bytes, &error),
                     SHEEN_OK);
    assert_int_equal(n_bytes, 3);
    assert_memory_equal(bytes, "abc", 3);
    free(bytes);
    static const char *const links[] = {"real/link", "folder/a"};
    for (size_t i = 0; i < sizeof links / sizeof *links; i++) {
        assert_holds(links[i], "abc");
        assert_int_equal(read_file_linkless(links[i], SHEEN_BAD_MODEL, &bytes, &n_bytes, &error),
                         SHEEN_BAD_MODEL);
        assert_non_null(strstr(error.text, "Too many levels of symbolic links"));
    }
    unlink("folder");
    unlink("real/link");
    unlink("real/a");
    rmdir("real");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(written_files_replace_old_ones),
        cmocka_unit_test(a_stale_temporary_is_stepped_over),
        cmocka_unit_test(a_full_disk_leaves_what_was_there),
        cmocka_unit_test(places_that_take_no_file),
        cmocka_unit_test(links_are_followed),
        cmocka_unit_test(files_that_cannot_be_read),
        cmocka_unit_test(links_are_refused_anywhere_in_a_path),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
