/* Splits the text of an OBJ file into lines and fields. Internal to the OBJ reader.
 *
 * A line ends at LF, CR LF or CR. A backslash before the end of a line joins the next line; '#' at
 * the start of a field begins a comment, which a backslash does not continue. Fields point into the
 * file: nothing is copied. Any thread; cannot fail. */
#ifndef SHEEN_CAGE_READ_OBJ_TEXT_H
#define SHEEN_CAGE_READ_OBJ_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

struct obj_text {
    const char *at, *end;
    uint32_t line; /* from 1 */
};

struct obj_field {
    const char *text;
    size_t length; /* >= 1 */
};

/* Gets the next field of the current line; false at the line's end. */
bool obj_text_field(struct obj_text *text, struct obj_field *field);

/* Moves behind the end of the current line, whatever is left on it. */
void obj_text_next_line(struct obj_text *text);

static inline bool obj_field_is(const struct obj_field *field, const char *word)
{
    return strlen(word) == field->length && memcmp(field->text, word, field->length) == 0;
}

#endif
