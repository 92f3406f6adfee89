#include "deploy/manual/page.h"

#include <ctype.h>
#include <stdbool.h>
#include <string.h>

#define LINE_BYTES 72 /* length of lines in a page's source; mandoc complains above 80 */

/* Escapes characters that have a meaning in the man language, or would be printed differently. */
static void put_escaped(FILE *out, const char *text, size_t length)
{
    static const struct {
        char c;
        const char *escape;
    } escapes[] = {{'\\', "\\e"},  {'-', "\\-"},   {'\'', "\\(aq"}, {'`', "\\(ga"},
                   {'^', "\\(ha"}, {'~', "\\(ti"}, {'"', "\\(dq"}};
    for (size_t i = 0; i < length; i++) {
        size_t k = 0, n = sizeof(escapes) / sizeof(*escapes);
        while (k < n && escapes[k].c != text[i])
            k++;
        if (k < n)
            fputs(escapes[k].escape, out);
        else
            fputc(text[i], out);
    }
}

/* Writes one paragraph, filled into lines, the first of which already has `column` characters. Each
 * sentence begins a new line. Returns what follows the paragraph. */
static const char *put_paragraph(FILE *out, const char *text, size_t column)
{
    bool is_first = true;
    while (*text && strncmp(text, "\n\n", 2) != 0) {
        size_t length = strcspn(text, " \n");
        if (length > 0 && !is_first) {
            bool is_end = column + 1 + length > LINE_BYTES || text[-2] == '.';
            fputc(is_end ? '\n' : ' ', out);
            column = is_end ? 0 : column + 1;
        }
        if (length > 0 && column == 0 && *text == '.')
            fputs("\\&", out);
        put_escaped(out, text, length);
        is_first = false;
        column += length;
        text += length;
        while (*text == ' ' || (*text == '\n' && text[1] != '\n'))
            text++;
    }
    fputc('\n', out);
    return text + strspn(text, "\n");
}

void page_text(FILE *out, const char *text)
{
    for (text = put_paragraph(out, text, 0); *text; text = put_paragraph(out, text, 0))
        fputs(".PP\n", out);
}

void page_paragraph(FILE *out, const char *text)
{
    fputs(".PP\n", out);
    page_text(out, text);
}

void page_begin(FILE *out, const char *name, int section, const char *date, const char *summary)
{
    fputs(".TH ", out);
    for (const char *c = name; *c; c++)
        fputc(toupper((unsigned char)*c), out);
    fprintf(out, " %d %s \"sheen %s\" \"Exact reflection lines\"\n.SH NAME\n", section, date,
            SHEEN_VERSION);
    put_escaped(out, name, strlen(name));
    fputs(" \\- ", out);
    put_paragraph(out, summary, strlen(name) + strlen(" \\- "));
}

void page_section(FILE *out, const char *title)
{
    fprintf(out, ".SH %s\n", title);
}

void page_item(FILE *out, const char *term, const char *argument, const char *text)
{
    fputs(".TP\n\\fB", out);
    put_escaped(out, term, strlen(term));
    fputs("\\fR", out);
    if (argument) {
        fputs(" \\fI", out);
        put_escaped(out, argument, strlen(argument));
        fputs("\\fR", out);
    }
    fputc('\n', out);
    page_text(out, text);
}

void page_lines(FILE *out, const char *lines)
{
    fputs(".nf\n", out);
    while (*lines) {
        size_t length = strcspn(lines, "\n"), blanks = strspn(lines, " ");
        if (lines[blanks] == '.' || lines[0] == ' ')
            fputs("\\&", out);
        put_escaped(out, lines, length);
        fputc('\n', out);
        lines += length + (lines[length] == '\n');
    }
    fputs(".fi\n", out);
}

void page_see_also(FILE *out, const char *names)
{
    page_section(out, "SEE ALSO");
    while (*names) {
        size_t length = strcspn(names, "("), rest = strcspn(names + length, " ");
        fputs(".BR ", out);
        put_escaped(out, names, length);
        fprintf(out, " %.*s\n", (int)rest, names + length);
        names += length + rest;
        names += *names == ' ';
    }
}
