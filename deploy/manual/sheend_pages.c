/* sheend_pages DATE FOLDER: writes the manual pages of the daemon, sheend.8 and sheend.conf.5, and
 * its completions for bash, zsh and fish, all from the table of options that --help prints. */
#include <string.h>

#include "deploy/manual/output.h"
#include "deploy/manual/page.h"
#include "deploy/manual/shell.h"
#include "server/ops/options_table.h"

#define RELOADS "The value is read again on SIGHUP."

/* Writes the meaning of an option, and whether the file and a reload take it. */
static void write_row(FILE *out, const struct option_row *row, bool in_file)
{
    char help[OPTION_HELP_BYTES], text[OPTION_HELP_BYTES + 128], term[64];
    const char *value = row->type == OPTION_FLAG && in_file ? "yes|no" : row->argument;
    snprintf(text, sizeof(text), "%s%s", option_help(row, help),
             row->flags & OPTION_RELOADS ? ". " RELOADS : "");
    snprintf(term, sizeof(term), "%s%s%s", in_file ? "" : "--", row->name, in_file ? " =" : "");
    page_item(out, term, value, text);
}

/* Writes the rows that are limits, or those that are not. */
static void write_rows(FILE *out, bool limits, bool in_file)
{
    size_t n;
    const struct option_row *rows = option_rows(&n);
    for (size_t i = 0; i < n; i++)
        if ((rows[i].type == OPTION_LIMIT) == limits &&
            (!in_file || rows[i].flags & OPTION_IN_FILE))
            write_row(out, &rows[i], in_file);
}

static void write_daemon(FILE *out, const char *date)
{
    static const struct {
        const char *code, *meaning;
    } codes[] = {{"0", "done"},
                 {"2", "wrong usage"},
                 {"4", "cannot serve"},
                 {"5", "no device"},
                 {"75", "the GPU was lost too often"}};
    page_begin(out, "sheend", 8, date, "daemon for exact reflection lines on subdivision surfaces");
    page_section(out, "SYNOPSIS");
    page_text(out, "sheend [option]...");
    page_section(out, "DESCRIPTION");
    page_text(out,
              "sheend renders exact reflection lines on subdivision surfaces for clients of its "
              "socket: sheen(1), and programs with libsheen.\n\n"
              "The daemon keeps each model's tables on the GPU, and answers requests with "
              "images or planes of floats. Files from clients are read by processes of their "
              "own, which may do nothing else.");
    page_section(out, "OPTIONS");
    write_rows(out, false, false);
    page_section(out, "LIMITS");
    page_text(out, "Bytes take K, M, G and T.");
    write_rows(out, true, false);
    page_section(out, "SIGNALS");
    page_item(out, "SIGHUP", NULL,
              "Reads the configuration again and takes the options from it that this page says "
              "are read again. A bad configuration changes nothing and is logged.");
    page_item(out, "SIGTERM", NULL,
              "As SIGINT: finishes what is in flight; a second one ends the daemon at once.");
    page_section(out, "EXIT STATUS");
    for (size_t i = 0; i < sizeof(codes) / sizeof(*codes); i++)
        page_item(out, codes[i].code, NULL, codes[i].meaning);
    page_section(out, "EXAMPLES");
    page_lines(out, "sheend --listen unix:/run/sheen/sheen.sock\n"
                    "sheend --listen tcp:127.0.0.1:7410 --device software --memory-budget 2G\n"
                    "sheend --config /etc/sheen/sheend.conf --check-config\n");
    page_see_also(out, "sheend.conf(5), sheen(1)");
}

static void write_file(FILE *out, const char *date)
{
    page_begin(out, "sheend.conf", 5, date, "configuration of sheend");
    page_section(out, "DESCRIPTION");
    page_text(out, "sheend reads the file that --config names; the service of systemd names "
                   "/etc/sheen/sheend.conf. Lines are 'name = value', each name once but for those "
                   "that may be given several times. A line that begins with # or ; is a remark, "
                   "and a line [sheend] may stand before the others. Options of the command line "
                   "go before the file's.\n\n"
                   "sheend --check-config says whether a file is good.");
    page_section(out, "NAMES");
    write_rows(out, false, true);
    page_section(out, "LIMITS");
    page_text(out, "Bytes take K, M, G and T.");
    write_rows(out, true, true);
    page_section(out, "EXAMPLES");
    page_lines(out, "[sheend]\n"
                    "listen = unix:/run/sheen/sheen.sock\n"
                    "memory-budget = 4G\n"
                    "log-level = info\n");
    page_see_also(out, "sheend(8)");
}

/* Extracts the fixed words of an argument: "auto software" from "auto|software|N". */
static const char *words_of(const char *argument, char words[static 64])
{
    size_t used = 0;
    while (strchr(argument, '|') || used > 0) {
        int length = (int)strcspn(argument, "|");
        if (*argument >= 'a' && *argument <= 'z')
            used += (size_t)snprintf(words + used, 64 - used, "%s%.*s", used ? " " : "", length,
                                     argument);
        argument += length;
        if (*argument++ == 0 || used >= 64)
            return words;
    }
    return NULL;
}

static void write_shells(const char *folder)
{
    static struct shell_option options[OPTION_MAX_ROWS];
    static char words[OPTION_MAX_ROWS][64];
    size_t n;
    const struct option_row *rows = option_rows(&n);
    for (size_t i = 0; i < n; i++) {
        const char *argument = rows[i].argument ? rows[i].argument : "";
        enum shell_value value = !rows[i].argument               ? SHELL_FLAG
                                 : strcmp(argument, "FILE") == 0 ? SHELL_FILE
                                 : strcmp(argument, "DIR") == 0  ? SHELL_FOLDER
                                                                 : SHELL_VALUE;
        options[i] = (struct shell_option){.name = rows[i].name,
                                           .value = value,
                                           .words = words_of(argument, words[i]),
                                           .help = rows[i].help};
    }
    const struct shell_command all = {.n_options = n, .options = options, .summary = ""};
    output_shells(folder, &(struct shell_program){"sheend", 1, &all});
}

int main(int argc, char **argv)
{
    if (argc != 3) {
        fputs("usage: sheend_pages DATE FOLDER\n", stderr);
        return 2;
    }
    FILE *out = output_open(argv[2], "sheend.8");
    write_daemon(out, argv[1]);
    output_close(out);
    out = output_open(argv[2], "sheend.conf.5");
    write_file(out, argv[1]);
    output_close(out);
    write_shells(argv[2]);
    return 0;
}
