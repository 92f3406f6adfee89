#include "server/ops/options.h"

#include <errno.h>
#include <getopt.h>
#include <ini.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/frame.h"
#include "server/ops/options_table.h"
#include "server/base/plain_file.h"
#include "server/net/listen.h"

#define HELP_COLUMN 28

/* --- --help */

static void print_row(const struct option_row *row)
{
    char name[64];
    snprintf(name, sizeof name, "--%s %s", row->name, row->argument ? row->argument : "");
    printf("%c %-*s", row->flags & OPTION_RELOADS ? '*' : ' ', HELP_COLUMN - 2, name);
    if (strlen(name) >= HELP_COLUMN - 2)
        printf("\n%-*s", HELP_COLUMN, "");
    char help[OPTION_HELP_BYTES];
    for (const char *c = option_help(row, help); *c; c++)
        *c == '\n' ? (void)printf("\n%-*s", HELP_COLUMN, "") : (void)putchar(*c);
    putchar('\n');
}

static void print_help(void)
{
    puts(
        "sheend renders exact reflection lines on subdivision surfaces for clients of its socket.\n"
        "\nusage: sheend [options]\n");
    size_t n;
    const struct option_row *rows = option_rows(&n);
    for (size_t i = 0; i < n; i++) {
        if (rows[i].type == OPTION_LIMIT && rows[i - 1].type != OPTION_LIMIT)
            puts("\nlimits; bytes take K, M, G, T:");
        print_row(&rows[i]);
    }
    puts(
        "\nexamples:\n"
        "  sheend                                       a daemon for this user alone\n"
        "  sheend --listen unix:/run/sheen/sheen.sock   at a place of your choice\n"
        "  sheend --listen tcp:127.0.0.1:7410 --device software --memory-budget 2G\n"
        "  sheend --config /etc/sheen/sheend.conf --check-config\n"
        "  sheend --hash-token farm:2027-12-31 < token >> tokens\n"
        "  sheend --listen tls:0.0.0.0:7410 --tls-cert a.pem --tls-key a.key --tokens tokens\n"
        "\nSIGHUP reads the configuration again and takes the options marked * from it; a bad one\n"
        "changes nothing and is logged. SIGTERM and SIGINT finish what is in flight; a second\n"
        "one ends at once.\n"
        "exit codes: 0 done, 2 wrong usage, 4 cannot serve, 5 no device, 75 the GPU was lost too "
        "often");
}

/* --- reading */

static const struct option_row *find_row(const char *name)
{
    size_t n;
    const struct option_row *rows = option_rows(&n);
    for (size_t i = 0; i < n; i++)
        if (strcmp(name, rows[i].name) == 0)
            return &rows[i];
    return NULL;
}

struct file_reader {
    struct settings *settings;
    FILE *file;
    int line;                   /* number of the last line read; reading stops at the first error */
    bool seen[OPTION_MAX_ROWS]; /* the rows that the file has set */
    struct error error;
};

/* Refuses lines that inih would cut off or misread without an error. */
static bool check_line(const char *line, size_t length, bool is_whole, struct error *error)
{
    static const char blank[] = " \t\v\f\r\n";
    const char *first = line + strspn(line, blank), *behind = strchr(first, ']');
    if (memchr(line, 0, length))
        return error_set(error, ERROR_REQUEST, "there is a zero byte in the line");
    if (!is_whole)
        return error_set(error, ERROR_REQUEST, "the line has more than %zu bytes", length);
    if (first > line && *first && !strchr("#;", *first))
        return error_set(error, ERROR_REQUEST,
                         "the line is indented; 'name = value' stands on a line of its own and "
                         "begins with its name");
    if (*first == '[' && behind && behind[1 + strspn(behind + 1, blank)])
        return error_set(error, ERROR_REQUEST, "nothing may stand behind a section's name");
    return true;
}

static bool is_at_end(FILE *file)
{
    int c = getc(file);
    return c == EOF || ungetc(c, file) == EOF;
}

/* The reader for inih, which calls it like fgets(). */
static char *read_line(char *text, int capacity, void *stream)
{
    struct file_reader *reader = stream;
    size_t n = 0, most = (size_t)capacity - 1;
    int c = 0;
    if (reader->error.kind != ERROR_NONE)
        return NULL;
    while (n < most && c != '\n' && (c = getc(reader->file)) != EOF)
        text[n++] = (char)c;
    text[n] = 0;
    if (n == 0)
        return NULL;
    reader->line++;
    bool is_whole = n < most || c == '\n' || is_at_end(reader->file);
    return check_line(text, n, is_whole, &reader->error) ? text : NULL;
}

/* The handler for inih, which takes 0 for an error. */
static int file_value(void *user, const char *section, const char *name, const char *value)
{
    struct file_reader *reader = user;
    if (*section && strcmp(section, "sheend") != 0)
        return error_set(&reader->error, ERROR_REQUEST, "unknown section [%s]; use [sheend]",
                         section);
    const struct option_row *row = find_row(name);
    if (!row || !(row->flags & OPTION_IN_FILE))
        return error_set(&reader->error, ERROR_REQUEST,
                         "unknown name '%s'; sheend --help lists them", name);
    size_t n;
    bool *seen = &reader->seen[row - option_rows(&n)];
    if (*seen && row->type != OPTION_LIST)
        return error_set(&reader->error, ERROR_REQUEST, "%s has a line before this one", name);
    *seen = true;
    return option_set(row, reader->settings, value, &reader->error);
}

static bool read_file(struct settings *settings, struct error *error)
{
    struct file_reader reader = {.settings = settings};
    if (!plain_file_check(settings->config, error))
        return false;
    if (!(reader.file = fopen(settings->config, "re")))
        return error_set(error, ERROR_REQUEST, "cannot read %s: %s", settings->config,
                         strerror(errno));
    int wrong = ini_parse_stream(read_line, &reader, file_value, &reader);
    bool is_read = !ferror(reader.file) && wrong >= 0, has_error = reader.error.kind != ERROR_NONE;
    fclose(reader.file);
    if (!is_read)
        return error_set(error, ERROR_REQUEST, "cannot read %s to its end", settings->config);
    if (wrong > 0 && (!has_error || wrong < reader.line)) /* an error that inih found before ours */
        return error_set(error, ERROR_REQUEST, "%s:%d: a line must be 'name = value'",
                         settings->config, wrong);
    return !has_error || error_set(error, ERROR_REQUEST, "%s:%d: %s", settings->config, reader.line,
                                   reader.error.text);
}

/* Takes one option of the command line. *seen: the option has occurred before. */
static bool take(const struct option_row *row, struct settings *settings, bool *seen,
                 struct error *error)
{
    if (row->type == OPTION_LIST && !*seen)
        memset((char *)settings + row->offset, 0, row->size);
    *seen = true;
    return option_set(row, settings, row->argument ? optarg : "yes", error);
}

static bool is_config(const struct option_row *row)
{
    return row->offset == offsetof(struct settings, config);
}

/* Tells what is wrong with an option that getopt does not take. */
static void refuse(bool lacks_value, const char *given, const struct option_row *rows, size_t n,
                   struct error *error)
{
    const size_t length = strcspn(given, "=");
    size_t n_names = 0;
    const struct option_row *exact = NULL;
    for (size_t i = 0; i < n && length > 2; i++) {
        if (strncmp(given + 2, rows[i].name, length - 2) != 0)
            continue;
        n_names++;
        if (strlen(rows[i].name) == length - 2)
            exact = &rows[i];
    }
    if (lacks_value)
        error_set(error, ERROR_REQUEST, "%s needs a value; sheend --help lists the options", given);
    else if (exact)
        error_set(error, ERROR_REQUEST, "--%s takes no value", exact->name);
    else if (n_names > 1)
        error_set(error, ERROR_REQUEST,
                  "'%s' may be %zu options: write more of it; sheend --help lists them", given,
                  n_names);
    else
        error_set(error, ERROR_REQUEST, "'%s' is no option; sheend --help lists them", given);
}

/* Walks the command line. The first walk takes --config and the options that act at once; the
 * second takes all others, so that they replace the values of the file. */
static enum options_result walk(int argc, char **argv, struct settings *settings, bool first,
                                struct error *error)
{
    enum { FIRST_LONG = 256 }; /* above all letters */
    struct option longs[OPTION_MAX_ROWS + 1] = {{0}};
    bool seen[OPTION_MAX_ROWS] = {false};
    size_t n;
    const struct option_row *rows = option_rows(&n);
    for (size_t i = 0; i < n; i++)
        /* Each has a value of its own: else getopt takes the first letters of several as the first of them. */
        longs[i] = (struct option){rows[i].name, rows[i].argument ? required_argument : no_argument,
                                   NULL, FIRST_LONG + (int)i};
    optind = 1;
    opterr = 0;
    for (int c, index; (c = getopt_long(argc, argv, ":", longs, &index)) != -1;) {
        if (c < FIRST_LONG) {
            refuse(c == ':', argv[optind - 1], rows, n, error);
            return OPTIONS_WRONG;
        }
        const struct option_row *row = &rows[index];
        if (row->type == OPTION_ACTION && row->set)
            return row->set(NULL, optarg, error) ? OPTIONS_DONE : OPTIONS_WRONG;
        if (row->type == OPTION_ACTION) {
            if (strcmp(row->name, "help") == 0)
                print_help();
            else
                printf("sheend %s, protocol %d.%d\n", SHEEN_VERSION, PROTOCOL_MAJOR,
                       PROTOCOL_MINOR);
            return OPTIONS_DONE;
        }
        if (is_config(row) == first && !take(row, settings, &seen[index], error))
            return OPTIONS_WRONG;
    }
    if (optind == argc)
        return OPTIONS_SERVE;
    error_set(error, ERROR_REQUEST, "'%s' is no option; sheend --help lists them", argv[optind]);
    return OPTIONS_WRONG;
}

static bool set_defaults(struct settings *settings, struct error *error)
{
    memset(settings, 0, sizeof *settings);
    size_t n;
    const struct option_row *rows = option_rows(&n);
    for (size_t i = 0; i < n; i++)
        if (rows[i].initial && !option_set(&rows[i], settings, rows[i].initial, error))
            return false;
    return true;
}

enum options_result options_read(int argc, char **argv, struct settings *settings,
                                 struct error *error)
{
    _Static_assert(sizeof(bool) == 1, "flags are compared as bytes");
    if (!set_defaults(settings, error))
        return OPTIONS_WRONG;
    enum options_result result = walk(argc, argv, settings, true, error);
    if (result != OPTIONS_SERVE)
        return result;
    if (*settings->config && !read_file(settings, error))
        return OPTIONS_WRONG;
    result = walk(argc, argv, settings, false, error);
    if (result == OPTIONS_SERVE && !service_options_check(&settings->service, error))
        return OPTIONS_WRONG;
    return result == OPTIONS_SERVE && settings->check_config ? OPTIONS_CHECK : result;
}

void options_reload(struct settings *settings, const struct settings *fresh,
                    char kept[static OPTIONS_CHANGED_BYTES])
{
    size_t used = 0;
    kept[0] = 0;
    size_t n;
    const struct option_row *rows = option_rows(&n);
    for (size_t i = 0; i < n; i++) {
        const struct option_row *row = &rows[i];
        char *value = (char *)settings + row->offset;
        const char *other = (const char *)fresh + row->offset;
        if (row->size == 0 || memcmp(value, other, row->size) == 0)
            continue;
        if (row->flags & OPTION_RELOADS)
            memcpy(value, other, row->size);
        else if (used < OPTIONS_CHANGED_BYTES)
            used += (size_t)snprintf(kept + used, OPTIONS_CHANGED_BYTES - used, "%s%s",
                                     used ? ", " : "", row->name);
    }
}
