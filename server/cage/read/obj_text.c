#include "server/cage/read/obj_text.h"

/* The length of the line ending at `at`; 0 if there is none. */
static size_t ending_length(const char *at, const char *end)
{
    if (at == end)
        return 0;
    if (*at == '\n')
        return 1;
    if (*at != '\r')
        return 0;
    return at + 1 < end && at[1] == '\n' ? 2 : 1;
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

bool obj_text_field(struct obj_text *text, struct obj_field *field)
{
    const char *at = text->at, *end = text->end;
    for (;;) {
        size_t ending;
        while (at < end && is_blank(*at))
            at++;
        if (at == end || *at != '\\' || (ending = ending_length(at + 1, end)) == 0)
            break;
        at += 1 + ending;
        text->line++;
    }
    text->at = at;
    if (at == end || *at == '\n' || *at == '\r' || *at == '#')
        return false;
    while (at < end && !is_blank(*at) && *at != '\n' && *at != '\r' &&
           !(*at == '\\' && ending_length(at + 1, end) > 0))
        at++;
    *field = (struct obj_field){text->at, (size_t)(at - text->at)};
    text->at = at;
    return true;
}

void obj_text_next_line(struct obj_text *text)
{
    struct obj_field field;
    while (obj_text_field(text, &field))
        ;
    const char *at = text->at;
    while (at < text->end && *at != '\n' && *at != '\r')
        at++; /* the comment */
    at += ending_length(at, text->end);
    text->at = at;
    text->line++;
}
