/* Creates the files of the manual pages and completions. A failure ends the program with one line
 * on standard error and exit code 1.
 * Thread: one. */
#ifndef SHEEN_MANUAL_OUTPUT_H
#define SHEEN_MANUAL_OUTPUT_H

#include <stdio.h>

#include "deploy/manual/shell.h"

/* Creates a file in the folder; close it by output_close(). */
FILE *output_open(const char *folder, const char *name);
void output_close(FILE *out);

/* Writes the program's completions: NAME.bash, _NAME (zsh) and NAME.fish. */
void output_shells(const char *folder, const struct shell_program *program);

#endif
