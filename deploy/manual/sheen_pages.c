/* sheen_pages DATE FOLDER: writes the manual pages of the command, sheen.1 and sheen-COMMAND.1, and
 * its completions for bash, zsh and fish, all from the table of options that --help prints. */
#include <stdlib.h>
#include <string.h>

#include "client/cli/commands.h"
#include "client/lib/sheen.h"
#include "deploy/manual/output.h"
#include "deploy/manual/page.h"
#include "deploy/manual/shell.h"

static const struct {
    const char *name, *meaning;
} ENVIRONMENT[] = {
    {"SHEEN_SERVER", "The address of a running daemon, where --server is not given."},
    {"SHEEN_TOKEN_FILE", "The token's file, where --token-file is not given."},
    {"SHEEN_DAEMON",
     "The program that a private daemon is, where it is not the sheend beside sheen "
     "or on the PATH."},
    {"NO_COLOR", "Not empty: the progress bar has no colour."},
};

static void write_environment(FILE *out)
{
    page_section(out, "ENVIRONMENT");
    for (size_t i = 0; i < sizeof(ENVIRONMENT) / sizeof(*ENVIRONMENT); i++)
        page_item(out, ENVIRONMENT[i].name, NULL, ENVIRONMENT[i].meaning);
}

static void write_codes(FILE *out, const struct command *command)
{
    struct exit_code codes[OPTIONS_MAX_CODES];
    size_t n = options_codes(command, codes);
    page_section(out, "EXIT STATUS");
    for (size_t i = 0; i < n; i++) {
        char code[8];
        snprintf(code, sizeof(code), "%d", codes[i].code);
        page_item(out, code, NULL, codes[i].meaning);
    }
}

/* Writes an option's item, for example "-o, --output". */
static void write_row(FILE *out, const struct option_row *row)
{
    char help[OPTIONS_HELP_BYTES], term[64];
    options_row_help(row, help);
    if (row->letter)
        snprintf(term, sizeof(term), "-%c, --%s", row->letter, row->name);
    else
        snprintf(term, sizeof(term), "--%s", row->name);
    page_item(out, term, row->argument, help);
}

static void write_synopsis(FILE *out, const char *name, const char *arguments)
{
    char text[160];
    snprintf(text, sizeof(text), "sheen%s%s %s", name ? " " : "", name ? name : "", arguments);
    page_section(out, "SYNOPSIS");
    page_text(out, text);
}

/* Copies the first sentence of the summary, for the section NAME. */
static void first_sentence(const char *summary, char *text, size_t size)
{
    const char *end = strchr(summary, '.');
    const char *colon = strchr(summary, ':'), *semicolon = strchr(summary, ';');
    end = colon && (!end || colon < end) ? colon : end;
    end = semicolon && (!end || semicolon < end) ? semicolon : end;
    snprintf(text, size, "%.*s", end ? (int)(end - summary) : (int)strlen(summary), summary);
}

static void write_command(FILE *out, const struct command *command, const char *date)
{
    const struct option_row *rows[OPTIONS_MAX_ROWS];
    size_t n = options_rows(command, rows);
    char name[64], summary[240];
    snprintf(name, sizeof(name), "sheen-%s", command->name);
    first_sentence(command->summary, summary, sizeof(summary));
    page_begin(out, name, 1, date, summary);
    write_synopsis(out, command->name, command->arguments);
    page_section(out, "DESCRIPTION");
    page_text(out, command->summary);
    if (command->takes_model)
        page_paragraph(out, OPTIONS_MODEL_TEXT);
    page_section(out, "OPTIONS");
    for (size_t i = 0; i < n; i++)
        write_row(out, rows[i]);
    write_codes(out, command);
    if (command->codes & CODE_SERVER)
        write_environment(out);
    page_section(out, "EXAMPLES");
    page_lines(out, command->examples);
    page_see_also(out, "sheen(1), sheend(8)");
}

static void write_overview(FILE *out, const char *date)
{
    page_begin(out, "sheen", 1, date, "exact reflection lines on subdivision surfaces");
    write_synopsis(out, NULL, "COMMAND [argument]...");
    page_section(out, "DESCRIPTION");
    page_text(out, "sheen asks a sheend for pictures of reflection lines on the limit surface of a "
                   "subdivision model, exact at every pixel.\n\n"
                   "Without --server or SHEEN_SERVER a command starts a private sheend and ends it "
                   "with itself.");
    page_section(out, "COMMANDS");
    for (size_t i = 0; i < N_COMMANDS; i++) {
        char term[64];
        snprintf(term, sizeof(term), "sheen %s", COMMANDS[i]->name);
        page_item(out, term, COMMANDS[i]->arguments, COMMANDS[i]->summary);
    }
    page_section(out, "OPTIONS");
    page_item(out, "--help", NULL, "Lists the commands; behind a command, its options.");
    page_item(out, "--version", NULL, "Prints the version of sheen, and of the protocol.");
    write_environment(out);
    char names[256] = "";
    for (size_t i = 0; i < N_COMMANDS; i++) {
        size_t used = strlen(names);
        snprintf(names + used, sizeof(names) - used, "sheen-%s(1), ", COMMANDS[i]->name);
    }
    size_t used = strlen(names);
    snprintf(names + used, sizeof(names) - used, "sheend(8)");
    page_see_also(out, names);
}

/* ---- completions ---- */

static struct shell_option completed(const struct option_row *row,
                                     char help[static OPTIONS_HELP_BYTES])
{
    options_row_help(row, help);
    bool is_file = row->argument &&
                   (strcmp(row->argument, "FILE") == 0 || strcmp(row->argument, "PATTERN") == 0);
    return (struct shell_option){
        .name = row->name,
        .letter = row->letter,
        .value = !row->argument           ? SHELL_FLAG
                 : is_file && !row->words ? SHELL_FILE
                                          : SHELL_VALUE,
        .words = row->words,
        .help = help,
    };
}

static void write_shells(const char *folder)
{
    static struct shell_option options[N_COMMANDS][OPTIONS_MAX_ROWS];
    static char helps[N_COMMANDS][OPTIONS_MAX_ROWS][OPTIONS_HELP_BYTES];
    struct shell_command commands[N_COMMANDS];
    for (size_t c = 0; c < N_COMMANDS; c++) {
        const struct option_row *rows[OPTIONS_MAX_ROWS];
        size_t n = options_rows(COMMANDS[c], rows);
        for (size_t i = 0; i < n; i++)
            options[c][i] = completed(rows[i], helps[c][i]);
        commands[c] = (struct shell_command){.name = COMMANDS[c]->name,
                                             .summary = COMMANDS[c]->summary,
                                             .takes_files = COMMANDS[c]->takes_model,
                                             .n_options = n,
                                             .options = options[c]};
    }
    output_shells(folder, &(struct shell_program){"sheen", N_COMMANDS, commands});
}

int main(int argc, char **argv)
{
    if (argc != 3) {
        fputs("usage: sheen_pages DATE FOLDER\n", stderr);
        return 2;
    }
    const char *date = argv[1], *folder = argv[2];
    FILE *out = output_open(folder, "sheen.1");
    write_overview(out, date);
    output_close(out);
    for (size_t i = 0; i < N_COMMANDS; i++) {
        char name[64];
        snprintf(name, sizeof(name), "sheen-%s.1", COMMANDS[i]->name);
        out = output_open(folder, name);
        write_command(out, COMMANDS[i], date);
        output_close(out);
    }
    write_shells(folder);
    return 0;
}
