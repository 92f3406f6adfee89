#include "server/cage/cage.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char MORE_WARNINGS[] = "more warnings followed";

void cage_finish(struct cage *cage)
{
    free(cage->position);
    free(cage->face_start);
    free(cage->face_vertex);
    free(cage->crease);
    free(cage->corner);
    free(cage->hole);
    free(cage->patch);
    free(cage->warnings);
    *cage = (struct cage){0};
}

static bool ends_with(const char *text, const char *ending)
{
    size_t length = strlen(text), n = strlen(ending);
    return length >= n && memcmp(text + length - n, ending, n) == 0;
}

void cage_warn(struct cage *cage, const char *format, ...)
{
    if (!cage->warnings && !(cage->warnings = calloc(1, CAGE_WARNINGS_BYTES)))
        return; /* no failure for the sake of a warning */
    if (ends_with(cage->warnings, MORE_WARNINGS))
        return;
    char line[512];
    va_list args;
    va_start(args, format);
    vsnprintf(line, sizeof line, format, args);
    va_end(args);
    for (char *c = line; *c; c++)
        if ((unsigned char)*c < 0x20 || *c == 0x7f)
            *c = '?'; /* parts of the text come from files, and it is shown in terminals */
    size_t used = strlen(cage->warnings);
    if (used > 0)
        cage->warnings[used++] = '\n';
    /* Keeps room for MORE_WARNINGS and the newline before it. */
    bool fits = used + strlen(line) + 1 + sizeof MORE_WARNINGS <= CAGE_WARNINGS_BYTES;
    snprintf(cage->warnings + used, CAGE_WARNINGS_BYTES - used, "%s", fits ? line : MORE_WARNINGS);
}

static bool is_found(const struct cage *cage, enum cage_finding_kind kind)
{
    for (size_t i = 0; i < cage->n_findings; i++)
        if (cage->finding[i].kind == kind)
            return true;
    return false;
}

void cage_found(struct cage *cage, const struct cage_finding *finding, const char *name,
                const char *format, ...)
{
    char text[320];
    va_list args;
    if (cage->n_findings >= N_CAGE_FINDINGS || is_found(cage, finding->kind))
        return; /* finding[] has room for one of each kind */
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    cage->finding[cage->n_findings++] = *finding;
    if (finding->line)
        cage_warn(cage, "%s:%u: %s", name, finding->line, text);
    else if (finding->face != CAGE_NO_FACE)
        cage_warn(cage, "%s: face %u (counting from 0): %s", name, finding->face, text);
    else
        cage_warn(cage, "%s: %s", name, text);
}
