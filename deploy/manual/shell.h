/* Writes a program's completions for bash, zsh and fish. Errors stay in the stream.
 * Thread: one at a time for each stream. */
#ifndef SHEEN_MANUAL_SHELL_H
#define SHEEN_MANUAL_SHELL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum shell_value {
    SHELL_FLAG,  /* no value */
    SHELL_VALUE, /* a free value, or one of `words` */
    SHELL_FILE,
    SHELL_FOLDER,
};

struct shell_option {
    const char *name; /* without "--" */
    char letter;      /* 0: none */
    enum shell_value value;
    const char *words; /* values, separated by blanks; NULL: none */
    const char *help;  /* its first part is shown, and a short default */
};

/* A command of the program. A program without commands has one, with name NULL. */
struct shell_command {
    const char *name;
    const char *summary; /* as `help` */
    bool takes_files;    /* in addition to its options */
    size_t n_options;
    const struct shell_option *options;
};

struct shell_program {
    const char *name;
    size_t n_commands;
    const struct shell_command *commands;
};

void shell_bash(FILE *out, const struct shell_program *program);
void shell_zsh(FILE *out, const struct shell_program *program);
void shell_fish(FILE *out, const struct shell_program *program);

#endif
