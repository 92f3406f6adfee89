/* Reads a text of words and numbers, whose line breaks count only as blanks: .bpt files, and
 * sheen's own form of patches. '#' begins a comment. Internal to server/cage/read. Any thread. */
#ifndef SHEEN_CAGE_READ_WORDS_H
#define SHEEN_CAGE_READ_WORDS_H

#include <locale.h>

#include "server/cage/build/builder.h"
#include "server/cage/read/obj_text.h"

struct words {
    struct obj_text text;
    const char *name;
    locale_t c_locale;
    uint32_t line; /* of the latest word */
    struct error *error;
};

/* Begins at the first word. False with ERROR_MODEL for bytes that are no text, whose kind is named
 * by `kind` (".bpt"), or with ERROR_SERVER when memory is short. words_finish() is safe in both
 * cases. `name` and `bytes` are used until words_finish(). */
bool words_init(struct words *words, const void *bytes, size_t size, const char *name,
                const char *kind, struct error *error);
void words_finish(struct words *words);

/* Gets the next word; false at the end of the file. */
bool words_next(struct words *words, struct obj_field *word);

/* Sets ERROR_MODEL with the text "name:line: ..." and returns false. */
bool words_fail(const struct words *words, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Read `what`, for example "coordinate x of point 3": a finite number within CAGE_MAX_COORDINATE,
 * or a whole number from `low` to `high`. False with ERROR_MODEL. */
bool words_number(struct words *words, double *value, const char *what);
bool words_count(struct words *words, uint32_t low, uint32_t high, uint32_t *value,
                 const char *what);

/* Reads n points, of which messages say `what` ("point", "side v=0: point") and their number from
 * 1. False with ERROR_MODEL. */
bool words_points(struct words *words, double (*points)[3], size_t n, const char *what);

#endif
