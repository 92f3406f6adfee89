/* The table of commands. Each command is one file, command_NAME.c. */
#ifndef SHEEN_CLIENT_COMMANDS_H
#define SHEEN_CLIENT_COMMANDS_H

#include "client/cli/options/options.h"

extern const struct command COMMAND_RENDER;
extern const struct command COMMAND_STREAM;
extern const struct command COMMAND_INFO;
extern const struct command COMMAND_STATS;
extern const struct command COMMAND_LIGHTS;
extern const struct command COMMAND_PATTERNS;
extern const struct command COMMAND_LEVELS;
extern const struct command COMMAND_PICK;
extern const struct command COMMAND_BREAKS;
extern const struct command COMMAND_COMPARE;
extern const struct command COMMAND_LINES;

/* All commands, in the order in which they are listed. */
#define N_COMMANDS 11
extern const struct command *const COMMANDS[N_COMMANDS];

#endif
