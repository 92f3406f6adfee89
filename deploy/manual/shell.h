/* What bash, zsh and fish complete of a program. Errors stay in the stream. Thread: one stream
 * belongs to one thread. */
#ifndef SHEEN_MANUAL_SHELL_H
#define SHEEN_MANUAL_SHELL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum shell_value {
    SHELL_FLAG,  /* no value */
    SHELL_VALUE, /* one that nobody can guess, or one of `words` */
    SHELL_FILE,
    SHELL_FOLDER,
};

struct shell_option {
    const char *name; /* without "--" */
    char letter;      /* 0: none */
    enum shell_value value;
    const char *words; /* values with blanks between; NULL: none */
    const char *help;  /* shown as far as its first part goes */
};

/* A command of the program; of a program without commands there is one, its name NULL. */
struct shell_command {
    const char *name;
    const char *summary; /* as `help` */
    bool takes_files;    /* beside its options */
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
