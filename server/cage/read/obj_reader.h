/* What the parts of the OBJ reader, obj.c and obj_tags.c, share. Internal to them. */
#ifndef SHEEN_CAGE_READ_OBJ_READER_H
#define SHEEN_CAGE_READ_OBJ_READER_H

#include <locale.h>

#include "server/cage/build/builder.h"
#include "server/cage/read/obj_text.h"

struct obj_reader {
    struct obj_text text;
    struct cage_builder *builder;
    const char *name;
    locale_t c_locale;
    uint32_t line; /* where the current statement starts */
    bool warned_keyword, warned_facevarying, warned_negative;
    struct error *error;
};

/* The arguments of "%.*s" to show a field in a message, cut to 40 bytes. */
#define OBJ_SHOWN(field) (int)((field)->length < 40 ? (field)->length : 40), (field)->text

/* Sets ERROR_MODEL with the text "name:line: ..." and returns false. */
bool obj_fail(const struct obj_reader *reader, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Reads the rest of a line that begins with "t": an OpenSubdiv tag. Any blanks and any length are
 * accepted. A crease may have one sharpness for all edges, one for each edge, or, as OpenSubdiv
 * counts them, one for each vertex. Stops before the end of the line. */
bool obj_read_tag(struct obj_reader *reader);

#endif
