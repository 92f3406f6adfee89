/* --help of a command, and the parts that manual pages and completions use, too. */
#include <string.h>

#include "client/cli/options/options.h"

#define HELP_COLUMN 30

static bool names_option(const struct range *range, const char *name)
{
    const char *at = range->option ? strstr(range->option, name) : NULL;
    return at && strncmp(at - 2, "--", 2) == 0 && strchr(", ", at[strlen(name)]);
}

/* The n-th range of an option, of those from `first` on; NULL if it has fewer. */
static const struct range *range_of_option(const char *name, size_t first, size_t n)
{
    for (size_t i = first; i < N_RANGES + N_OPTION_RANGES; i++) {
        const struct range *range = i < N_RANGES ? &RANGES[i] : &OPTION_RANGES[i - N_RANGES];
        if (names_option(range, name) && n-- == 0)
            return range;
    }
    return NULL;
}

/* The length of the placeholder that a text begins with, and the first range that it may stand for; 0: there is none. */
static size_t placeholder(const char *text, size_t *first)
{
    static const struct {
        const char *text;
        size_t first;
    } placeholders[] = {{"{}", 0}, {"{client}", N_RANGES}};
    for (size_t i = 0; i < sizeof(placeholders) / sizeof(*placeholders); i++) {
        size_t length = strlen(placeholders[i].text);
        *first = placeholders[i].first;
        if (strncmp(text, placeholders[i].text, length) == 0)
            return length;
    }
    return 0;
}

void options_row_help(const struct option_row *row, char help[static OPTIONS_HELP_BYTES])
{
    char text[RANGE_TEXT_BYTES];
    size_t used = 0, n = 0, first;
    for (const char *from = row->help; *from && used + 1 < OPTIONS_HELP_BYTES;) {
        size_t length = placeholder(from, &first);
        const struct range *range = length ? range_of_option(row->name, first, n) : NULL;
        if (range) {
            used += (size_t)snprintf(help + used, OPTIONS_HELP_BYTES - used, "%s",
                                     range_text(range, text));
            from += length;
            n++;
        } else {
            help[used++] = *from++;
        }
    }
    help[used < OPTIONS_HELP_BYTES ? used : OPTIONS_HELP_BYTES - 1] = 0;
}

static void help_row(const struct option_row *row, FILE *out)
{
    char help[OPTIONS_HELP_BYTES];
    options_row_help(row, help);
    int column = row->letter ? fprintf(out, "  -%c, --%s", row->letter, row->name)
                             : fprintf(out, "      --%s", row->name);
    if (row->argument)
        column += fprintf(out, " %s", row->argument);
    for (const char *line = help; *line;) {
        int length = (int)strcspn(line, "\n");
        if (column >= HELP_COLUMN) {
            fputc('\n', out);
            column = 0;
        }
        fprintf(out, "%*s%.*s\n", HELP_COLUMN - column, "", length, line);
        line += length + (line[length] == '\n');
        column = 0;
    }
}

size_t options_codes(const struct command *command,
                     struct exit_code codes[static OPTIONS_MAX_CODES])
{
    size_t n = 0;
    codes[n++] = (struct exit_code){0, command->no ? "within the limits" : "done"};
    if (command->no)
        codes[n++] = (struct exit_code){1, command->no};
    codes[n++] = (struct exit_code){2, "wrong usage"};
    if (command->codes & CODE_FILES)
        codes[n++] = (struct exit_code){3, "bad model or image, or what cannot be written"};
    else if (command->codes & CODE_OUTPUT)
        codes[n++] = (struct exit_code){3, "standard output cannot be written"};
    if (command->codes & CODE_SERVER) {
        codes[n++] = (struct exit_code){4, command->codes & CODE_LATE
                                               ? "no or lost server, or --deadline passed"
                                               : "no or lost server"};
        codes[n++] = (struct exit_code){5, "device failed"};
    }
    return n;
}

/* Prints all exit codes in one sentence, on two lines if there are many. */
static void help_codes(const struct command *command, FILE *out)
{
    struct exit_code codes[OPTIONS_MAX_CODES];
    size_t n = options_codes(command, codes);
    fputs("\nExit codes:", out);
    for (size_t i = 0; i < n; i++)
        fprintf(out, "%s%d %s%s", i == 3 ? "\n" : " ", codes[i].code, codes[i].meaning,
                i + 1 < n ? "," : ".\n");
}

void options_help(const struct command *command, FILE *out)
{
    const struct option_row *rows[OPTIONS_MAX_ROWS];
    size_t n = options_rows(command, rows);
    fprintf(out, "usage: sheen %s %s\n%s\n\n", command->name, command->arguments, command->summary);
    for (size_t i = 0; i < n; i++)
        help_row(rows[i], out);
    if (command->takes_model)
        fputs("\n" OPTIONS_MODEL_TEXT "\n", out);
    if (command->old_name)
        fprintf(out, "\nThe command's old name, %s, still works.\n", command->old_name);
    fprintf(out, "\nexamples:\n%s", command->examples);
    help_codes(command, out);
}
