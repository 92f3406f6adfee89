/* A manual page in the man(7) language, as man, mandoc and groff read it. Texts are plain: what
 * they hold of the language is escaped. In a text '\n' is a blank, as lines are filled anew; an
 * empty line begins a paragraph. Errors stay in the stream. Thread: one stream belongs to one
 * thread. */
#ifndef SHEEN_MANUAL_PAGE_H
#define SHEEN_MANUAL_PAGE_H

#include <stdio.h>

/* The title, and section NAME. `date` is YYYY-MM-DD. */
void page_begin(FILE *out, const char *name, int section, const char *date, const char *summary);

void page_section(FILE *out, const char *title);
void page_text(FILE *out, const char *text);
void page_paragraph(FILE *out, const char *text); /* the same after a text */

/* One term of a list, in bold, `argument` (NULL: none) behind it in italics, and what it means. */
void page_item(FILE *out, const char *term, const char *argument, const char *text);

/* Lines as they are. */
void page_lines(FILE *out, const char *lines);

/* Section SEE ALSO: names with their sections and commas between, as "sheen(1), sheend(8)". */
void page_see_also(FILE *out, const char *names);

#endif
