/* Command lines for tests of the options. */
#ifndef SHEEN_TESTS_COMMAND_LINE_H
#define SHEEN_TESTS_COMMAND_LINE_H

#include <stdio.h>
#include <string.h>

#include "client/cli/commands.h"

/* Parses the words of `line`, separated by blanks, after the command's name. Strings in the options
 * are valid until the next call. */
static inline enum options_result parse(const struct command *command, const char *line,
                                        struct options *options, char *why)
{
    static char copy[1000];
    char *argv[32];
    int argc = 0;
    snprintf(copy, sizeof(copy), "%s %s", command->name, line);
    for (char *word = strtok(copy, " "); word; word = strtok(NULL, " "))
        argv[argc++] = word;
    argv[argc] = NULL;
    return options_parse(command, argc, argv, options, why);
}

#endif
