#include "server/cage/read/usd/layer.h"

#include <math.h>

/* One entry of metadata: "key = value" or, in lists, "prepend key = value". */
struct entry {
    struct usd_token key;
    struct usd_text value;
    bool is_empty;  /* the value is None or [] */
    bool takes_out; /* a `delete` or `reorder`: it adds nothing */
};

static bool is_list_word(const struct usd_token *token)
{
    static const char *const words[] = {"add", "append", "prepend", "delete", "reorder"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (usd_is_word(token, words[i]))
            return true;
    return false;
}

/* Reads the next entry; a text alone, which is a comment, is passed over. *more: false at the
 * closing parenthesis. */
static bool next_entry(struct usd_text *text, struct entry *entry, bool *more)
{
    struct usd_token token;
    do {
        if (!usd_next(text, &token))
            return false;
    } while (token.kind == USD_STRING);
    *more = !usd_is_sign(&token, ')');
    if (!*more)
        return true;
    bool is_list = is_list_word(&token);
    entry->takes_out = usd_is_word(&token, "delete") || usd_is_word(&token, "reorder");
    if (is_list && !usd_next(text, &token))
        return false;
    if (token.kind == USD_END)
        return usd_fail(text->file, token.line, "the file ends within '(', which is not closed");
    if (token.kind != USD_WORD)
        return usd_fail(text->file, token.line, "'%.*s' stands where a word of metadata must",
                        USD_SHOWN(&token));
    entry->key = token;
    if (!usd_expect(text, '=', "a word of metadata"))
        return false;
    entry->value = *text;
    return usd_skip_value(text, &entry->is_empty) && usd_skip_metadata(text);
}

/* The metadata that makes a prim take content from elsewhere, with the words for the message. */
static const char *arc_of(const struct usd_token *key)
{
    static const struct {
        const char *key, *what;
    } arcs[] = {
        {"references", "references"},   {"payload", "a payload"},    {"inherits", "inherits"},
        {"specializes", "specializes"}, {"variantSets", "variants"}, {"variants", "variants"},
        {"clips", "value clips"},
    };
    for (size_t i = 0; i < sizeof arcs / sizeof *arcs; i++)
        if (usd_is_word(key, arcs[i].key))
            return arcs[i].what;
    return NULL;
}

/* Reads the value of a flag, which older files write as 0 or 1, or "no" or "yes". */
static bool read_flag(const struct entry *entry, bool *flag)
{
    struct usd_text text = entry->value;
    struct usd_token token;
    if (!usd_next(&text, &token))
        return false;
    *flag = usd_is_word(&token, "true") || usd_text_is(&token, "1") || usd_is_word(&token, "yes");
    return true;
}

bool usd_prim_metadata(struct usd_text *text, struct usd_arc *arc, bool *is_active)
{
    struct entry entry;
    bool more;
    if (!usd_next_is(text, '(', &more))
        return false;
    while (more) {
        if (!next_entry(text, &entry, &more))
            return false;
        if (!more)
            break;
        if (usd_is_word(&entry.key, "active") && !read_flag(&entry, is_active))
            return false;
        if (usd_is_word(&entry.key, "instanceable") && !read_flag(&entry, &arc->is_instance))
            return false;
        const char *what = arc_of(&entry.key);
        if (what && !entry.is_empty && !entry.takes_out && !arc->what) {
            arc->what = what;
            arc->line = entry.key.line;
        }
    }
    return true;
}

static bool read_up(struct usd_layer *layer, struct usd_text *text)
{
    struct usd_token token;
    if (!usd_string(text, "upAxis", &token))
        return false;
    layer->up = usd_text_is(&token, "Z") ? CAGE_UP_Z : CAGE_UP_Y;
    return usd_text_is(&token, "Z") || usd_text_is(&token, "Y") ||
           usd_fail(text->file, token.line, "upAxis is '%.*s', needs Y or Z", USD_SHOWN(&token));
}

/* Lengths stay in the file's own units, whatever these are. */
static bool check_unit(struct usd_text *text)
{
    double metres;
    const uint32_t line = text->line;
    return usd_number(text, "metersPerUnit", &metres) &&
           (metres > 0 ||
            usd_fail(text->file, line, "metersPerUnit is %g, needs more than 0", metres));
}

bool usd_layer_metadata(struct usd_layer *layer, struct usd_text *text)
{
    struct entry entry;
    bool more;
    if (!usd_next_is(text, '(', &more))
        return false;
    while (more) {
        if (!next_entry(text, &entry, &more))
            return false;
        if (!more)
            break;
        if (usd_is_word(&entry.key, "upAxis") && !entry.is_empty && !read_up(layer, &entry.value))
            return false;
        if (usd_is_word(&entry.key, "metersPerUnit") && !entry.is_empty &&
            !check_unit(&entry.value))
            return false;
        if (usd_is_word(&entry.key, "subLayers") && !entry.is_empty && !entry.takes_out)
            return usd_fail(text->file, entry.key.line,
                            "the file takes content from other files by subLayers, and no other "
                            "file is read: make one file of them by usdcat --flatten");
    }
    return true;
}
