/* sheen: chooses the command. */
#include <stdio.h>
#include <string.h>

#include "client/cli/commands.h"

#define EXIT_WRONG_USAGE 2

static void print_help(FILE *out)
{
    fputs("usage: sheen COMMAND [argument]...\n"
          "Exact reflection lines on Catmull-Clark limit surfaces.\n\n",
          out);
    for (size_t i = 0; i < N_COMMANDS; i++)
        fprintf(out, "  sheen %s %s\n", COMMANDS[i]->name, COMMANDS[i]->arguments);
    fputs("\n"
          "  sheen COMMAND --help    options, ranges, defaults and examples\n"
          "  sheen --version\n\n"
          "Without --server ADDRESS (or SHEEN_SERVER in the environment) a command starts a\n"
          "private sheend, which ends with the command.\n",
          out);
}

/* What a command prints is its result: if it cannot be written, the command has failed. */
static int end_output(int code)
{
    if ((fflush(stdout) == 0 && !ferror(stdout)) || code != 0)
        return code;
    fputs("sheen: standard output cannot be written\n", stderr);
    return sheen_status_exit_code(SHEEN_BAD_IMAGE);
}

static bool is_called(const struct command *command, const char *name)
{
    return strcmp(name, command->name) == 0 ||
           (command->old_name && strcmp(name, command->old_name) == 0);
}

int main(int argc, char **argv)
{
    const char *name = argc > 1 ? argv[1] : "";
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0 || strcmp(name, "help") == 0) {
        print_help(stdout);
        return end_output(0);
    }
    if (strcmp(name, "--version") == 0) {
        printf("sheen %s\n", sheen_version());
        return end_output(0);
    }
    for (size_t i = 0; i < N_COMMANDS; i++) {
        if (!is_called(COMMANDS[i], name))
            continue;
        struct options options;
        char why[OPTIONS_WHY_BYTES];
        switch (options_parse(COMMANDS[i], argc - 1, argv + 1, &options, why)) {
        case OPTIONS_RUN:
            return end_output(COMMANDS[i]->run(&options));
        case OPTIONS_HELP:
            options_help(COMMANDS[i], stdout);
            return end_output(0);
        case OPTIONS_WRONG:
            fprintf(stderr, "sheen %s: %s; see sheen %s --help\n", name, why, name);
            return EXIT_WRONG_USAGE;
        }
    }
    if (*name)
        fprintf(stderr, "sheen: '%s' is no command; see sheen --help\n", name);
    else
        print_help(stderr);
    return EXIT_WRONG_USAGE;
}
