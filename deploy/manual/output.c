#include "deploy/manual/output.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

FILE *output_open(const char *folder, const char *name)
{
    char path[4096];
    int length = snprintf(path, sizeof(path), "%s/%s", folder, name);
    FILE *out = length < (int)sizeof(path) ? fopen(path, "we") : NULL;
    if (!out) {
        fprintf(stderr, "cannot write %s/%s: %s\n", folder, name, strerror(errno));
        exit(1);
    }
    return out;
}

void output_close(FILE *out)
{
    int failed = ferror(out);
    if (fclose(out) == 0 && !failed)
        return;
    fputs("cannot write a page to its end\n", stderr);
    exit(1);
}

static void output_shell(const char *folder, const char *before, const char *name,
                         const char *behind,
                         void (*write)(FILE *out, const struct shell_program *program),
                         const struct shell_program *program)
{
    char file[80];
    snprintf(file, sizeof(file), "%s%s%s", before, name, behind);
    FILE *out = output_open(folder, file);
    write(out, program);
    output_close(out);
}

void output_shells(const char *folder, const struct shell_program *program)
{
    output_shell(folder, "", program->name, ".bash", shell_bash, program);
    output_shell(folder, "_", program->name, "", shell_zsh, program);
    output_shell(folder, "", program->name, ".fish", shell_fish, program);
}
