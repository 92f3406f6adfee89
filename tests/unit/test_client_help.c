/* Compares --help and what completions offer with the tables of options. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#include "tests/unit/command_line.h"

static void help_shows_every_option(void **state)
{
    (void)state;
    static const struct command *const commands[] = {
        &COMMAND_RENDER, &COMMAND_STREAM, &COMMAND_INFO,   &COMMAND_STATS,
        &COMMAND_LEVELS, &COMMAND_BREAKS, &COMMAND_COMPARE};
    for (size_t i = 0; i < 7; i++) {
        char *text = NULL;
        size_t size = 0;
        FILE *out = open_memstream(&text, &size);
        options_help(commands[i], out);
        fclose(out);
        for (const struct option_row *const *table = commands[i]->tables; *table; table++)
            for (const struct option_row *row = *table; row->name; row++) {
                char name[40];
                snprintf(name, sizeof(name), "--%s", row->name);
                assert_non_null(strstr(text, name));
                assert_true(row->help && *row->help);
            }
        assert_non_null(strstr(text, "examples:"));
        free(text);
    }
}

/* The text is valid until the next call. */
static const char *help_of(const struct command *command)
{
    static char text[1 << 15];
    FILE *out = fmemopen(text, sizeof(text), "w");
    options_help(command, out);
    fclose(out);
    return text;
}

/* Each command lists its own exit codes, and lists none that it cannot return. */
static void help_has_the_commands_exit_codes(void **state)
{
    (void)state;
    static const struct {
        const struct command *command;
        const char *codes; /* in the order of the help text */
    } cases[] = {
        {&COMMAND_RENDER, "02345"}, {&COMMAND_STREAM, "02345"},  {&COMMAND_INFO, "02345"},
        {&COMMAND_LEVELS, "02345"}, {&COMMAND_STATS, "02345"},   {&COMMAND_LIGHTS, "023"},
        {&COMMAND_PATTERNS, "023"}, {&COMMAND_BREAKS, "012345"}, {&COMMAND_COMPARE, "012345"}};
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
        char found[11] = "";
        const char *codes = strstr(help_of(cases[i].command), "Exit codes: ");
        assert_non_null(codes);
        for (; *codes; codes++) {
            const char digit[] = {*codes, 0};
            if (strchr("0123456789", *codes) && codes[1] == ' ')
                strcat(found, digit);
        }
        assert_string_equal(found, cases[i].codes);
    }
    assert_non_null(strstr(help_of(&COMMAND_RENDER), "or --deadline passed"));
    assert_null(strstr(help_of(&COMMAND_STATS), "--deadline"));
    const char *text = help_of(&COMMAND_LEVELS);
    assert_non_null(strstr(text, "usage: sheen levels "));
    assert_non_null(strstr(text, "old name, figure7, still works"));
}

/* The help text contains no unreplaced placeholder of a range. */
static void help_has_the_ranges(void **state)
{
    (void)state;
    static const struct command *const commands[] = {&COMMAND_RENDER, &COMMAND_STREAM,
                                                     &COMMAND_LEVELS};
    static const char *const wanted[] = {"from 1e-6 to 179 degrees", "from 1 to 1000000",
                                         "each from 1 to 65536 pixels"};
    for (size_t i = 0; i < 3; i++) {
        const char *text = help_of(commands[i]);
        assert_null(strstr(text, "{}"));
        assert_non_null(strstr(text, wanted[i]));
    }
}

/* `pick` and `compare` have options of one name with different ranges. */
static void help_has_the_commands_own_range(void **state)
{
    (void)state;
    struct options options;
    char why[OPTIONS_WHY_BYTES];
    assert_non_null(strstr(help_of(&COMMAND_PICK), "places of --section, from 2 to 4096 "));
    assert_int_equal(parse(&COMMAND_PICK, "m.obj --section 0,0,9,9 --samples 4096", &options, why),
                     OPTIONS_RUN);
    assert_int_equal(parse(&COMMAND_PICK, "m.obj --section 0,0,9,9 --samples 4097", &options, why),
                     OPTIONS_WRONG);
    assert_non_null(strstr(help_of(&COMMAND_COMPARE), "both surfaces together, from 1000 to 1e8"));
}

/* The size in --help is the one that a command uses without --size. */
static void help_says_its_own_default_size(void **state)
{
    (void)state;
    static const struct {
        const struct command *command;
        const char *line;
    } cases[] = {{&COMMAND_RENDER, "m.obj -o a.png"},
                 {&COMMAND_STREAM, "m.obj --frames 1"},
                 {&COMMAND_LEVELS, "m.obj -o a.png"}};
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
        struct options options;
        char why[OPTIONS_WHY_BYTES], wanted[40], *text = NULL;
        size_t size = 0;
        assert_int_equal(parse(cases[i].command, cases[i].line, &options, why), OPTIONS_RUN);
        snprintf(wanted, sizeof(wanted), "(default: %ux%u),", options.request.width_px,
                 options.request.height_px);
        FILE *out = open_memstream(&text, &size);
        options_help(cases[i].command, out);
        fclose(out);
        const char *row = strstr(text, "--size WxH"), *end = strchr(row, '\n');
        assert_memory_equal(end - strlen(wanted), wanted, strlen(wanted));
        assert_null(strstr(end, "--size WxH"));
        free(text);
    }
}

/* The least --memory-budget in --help is taken; one byte less is refused, with the same words. */
static void help_says_the_least_memory(void **state)
{
    (void)state;
    struct options options;
    char why[OPTIONS_WHY_BYTES], line[80], words[40];
    const char *row = strstr(help_of(&COMMAND_INFO), "--memory-budget BYTES");
    assert_non_null(row);
    const char *least = strstr(row, "at least ");
    assert_non_null(least);
    unsigned long long mib = strtoull(least + strlen("at least "), NULL, 10);
    snprintf(words, sizeof(words), "at least %lluM;", mib);
    assert_memory_equal(least, words, strlen(words));
    snprintf(line, sizeof(line), "m.obj --memory-budget %lluM", mib);
    assert_int_equal(parse(&COMMAND_INFO, line, &options, why), OPTIONS_RUN);
    snprintf(line, sizeof(line), "m.obj --memory-budget %llu", (mib << 20) - 1);
    assert_int_equal(parse(&COMMAND_INFO, line, &options, why), OPTIONS_WRONG);
    snprintf(words, sizeof(words), "%lluM or more", mib);
    assert_non_null(strstr(why, words));
}

/* Each word that the shells offer for an option is accepted by that option. */
static void completed_words_are_values(void **state)
{
    (void)state;
    int n_words = 0;
    for (size_t i = 0; i < N_COMMANDS; i++) {
        const struct option_row *rows[OPTIONS_MAX_ROWS];
        size_t n = options_rows(COMMANDS[i], rows);
        for (size_t k = 0; k < n; k++) {
            char words[160], why[OPTIONS_WHY_BYTES];
            snprintf(words, sizeof(words), "%s", rows[k]->words ? rows[k]->words : "");
            for (char *word = strtok(words, " "); word; word = strtok(NULL, " ")) {
                struct options options = {.request = SHEEN_REQUEST_DEFAULTS};
                options.request.format = SHEEN_FORMAT_EXR; /* needed by --aov */
                if (!rows[k]->apply(&options, word, why))
                    fail_msg("--%s %s: %s", rows[k]->name, word, why);
                n_words++;
            }
            assert_true(!rows[k]->words || rows[k]->argument);
        }
    }
    assert_true(n_words > 100);
}

int main(void)
{
    unsetenv("SHEEN_SERVER");
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(help_shows_every_option),
        cmocka_unit_test(help_has_the_commands_exit_codes),
        cmocka_unit_test(help_has_the_ranges),
        cmocka_unit_test(help_has_the_commands_own_range),
        cmocka_unit_test(help_says_its_own_default_size),
        cmocka_unit_test(help_says_the_least_memory),
        cmocka_unit_test(completed_words_are_values),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
