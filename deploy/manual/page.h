/* Writes a manual page in the man(7) language, which man, mandoc and groff read. Texts are plain:
 * characters with a meaning in that language are escaped. In a text '\n' counts as a blank, because
 * lines are filled again; an empty line begins a paragraph. Errors stay in the stream.
 * Thread: one at a time for each stream. */
#ifndef SHEEN_MANUAL_PAGE_H
#define SHEEN_MANUAL_PAGE_H

#include <stdio.h>

/* Writes the title and the section NAME. `date` is YYYY-MM-DD. */
void page_begin(FILE *out, const char *name, int section, const char *date, const char *summary);

void page_section(FILE *out, const char *title);
void page_text(FILE *out, const char *text);
void page_paragraph(FILE *out, const char *text); /* a new paragraph after a text */

/* Writes a list's item: the term in bold, `argument` (NULL: none) in italics, and the text. */
void page_item(FILE *out, const char *term, const char *argument, const char *text);

/* Writes lines unchanged, without filling. */
void page_lines(FILE *out, const char *lines);

/* Writes the section SEE ALSO; `names` is for example "sheen(1), sheend(8)". */
void page_see_also(FILE *out, const char *names);

#endif
