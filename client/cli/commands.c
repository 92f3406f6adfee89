#include "client/cli/commands.h"

const struct command *const COMMANDS[N_COMMANDS] = {
    &COMMAND_RENDER, &COMMAND_STREAM,   &COMMAND_INFO,   &COMMAND_STATS,
    &COMMAND_LIGHTS, &COMMAND_PATTERNS, &COMMAND_LEVELS,
};
