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

/* NULL: there is no such command. */
static const struct command *command_of(const char *name)
{
    for (size_t i = 0; i < N_COMMANDS; i++)
        if (is_called(COMMANDS[i], name))
            return COMMANDS[i];
    return NULL;
}

static int refuse_command(const char *name)
{
    fprintf(stderr, "sheen: '%s' is no command; see sheen --help\n", name);
    return EXIT_WRONG_USAGE;
}

/* sheen help [COMMAND] */
static int help(const char *name)
{
    const struct command *command = name ? command_of(name) : NULL;
    if (name && !command)
        return refuse_command(name);
    if (command)
        options_help(command, stdout);
    else
        print_help(stdout);
    return end_output(0);
}

static int run(const struct command *command, int argc, char **argv)
{
    struct options options;
    char why[OPTIONS_WHY_BYTES];
    switch (options_parse(command, argc, argv, &options, why)) {
    case OPTIONS_RUN:
        return end_output(command->run(&options));
    case OPTIONS_HELP:
        options_help(command, stdout);
        return end_output(0);
    case OPTIONS_WRONG:
        break;
    }
    fprintf(stderr, "sheen %s: %s; see sheen %s --help\n", argv[0], why, argv[0]);
    return EXIT_WRONG_USAGE;
}

int main(int argc, char **argv)
{
    const char *name = argc > 1 ? argv[1] : "";
    if (strcmp(name, "help") == 0)
        return help(argc > 2 ? argv[2] : NULL);
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0)
        return help(NULL);
    if (strcmp(name, "--version") == 0) {
        printf("sheen %s\n", sheen_version());
        return end_output(0);
    }
    if (strncmp(name, "--help=", 7) == 0 || strncmp(name, "--version=", 10) == 0) {
        fprintf(stderr, "sheen: %.*s takes no value; see sheen --help\n", (int)strcspn(name, "="),
                name);
        return EXIT_WRONG_USAGE;
    }
    const struct command *command = command_of(name);
    if (command)
        return run(command, argc - 1, argv + 1);
    if (*name)
        return refuse_command(name);
    print_help(stderr);
    return EXIT_WRONG_USAGE;
}
