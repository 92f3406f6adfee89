#include "server/cage/read/usd/layer.h"

#include <stdlib.h>

/* The prims that are open at a place of the file. */
struct parser {
    struct usd_layer *layer;
    struct usd_text text;
    uint32_t depth; /* the number of open prims */
    /* For each open prim its index in the layer; USD_NONE: it is left out. */
    uint32_t open[USD_MAX_DEPTH];
};

void usd_layer_finish(struct usd_layer *layer)
{
    free(layer->prim);
    free(layer->property);
    *layer = (struct usd_layer){0};
}

static bool add_prim(struct usd_layer *layer, const struct usd_prim *prim)
{
    const struct usd_file *file = layer->file;
    if (layer->n_prims == USD_MAX_PRIMS)
        return usd_fail(file, prim->name.line, "more than %d prims are not read", USD_MAX_PRIMS);
    if (layer->n_prims == layer->prim_capacity) {
        size_t wanted = layer->prim_capacity ? 2 * layer->prim_capacity : 64;
        struct usd_prim *grown = realloc(layer->prim, wanted * sizeof *grown);
        if (!grown)
            return error_set(file->error, ERROR_SERVER, "%s: not enough memory for %zu prims",
                             file->name, layer->n_prims);
        layer->prim = grown;
        layer->prim_capacity = wanted;
    }
    layer->prim[layer->n_prims++] = *prim;
    return true;
}

/* Types of prims that no renderer looks into for surfaces. */
static bool has_no_surface(const struct usd_token *type)
{
    return usd_text_is(type, "Material") || usd_text_is(type, "Shader") ||
           usd_text_is(type, "NodeGraph") || usd_text_is(type, "GeomSubset");
}

/* Reads a type, if there is one, and the name. */
static bool read_header(struct usd_text *text, const struct usd_token *specifier,
                        struct usd_prim *prim)
{
    if (!usd_next(text, &prim->name))
        return false;
    if (prim->name.kind == USD_WORD) {
        prim->type = prim->name;
        if (!usd_next(text, &prim->name))
            return false;
    }
    if (prim->name.kind == USD_END)
        return usd_fail(text->file, prim->name.line, "the file ends within a prim's header");
    return prim->name.kind == USD_STRING ||
           usd_fail(text->file, prim->name.line, "%.*s needs a name in quotes, not '%.*s'",
                    USD_SHOWN(specifier), USD_SHOWN(&prim->name));
}

/* Reads a prim from after `def`, `over` or `class` to its '{', and opens it. */
static bool open_prim(struct parser *parser, const struct usd_token *specifier)
{
    struct usd_layer *layer = parser->layer;
    struct usd_text *text = &parser->text;
    struct usd_prim prim = {
        .depth = parser->depth, .first_property = USD_NONE, .last_property = USD_NONE};
    bool is_active = true, is_def = usd_is_word(specifier, "def");
    if (!read_header(text, specifier, &prim))
        return false;
    if (parser->depth == USD_MAX_DEPTH)
        return usd_fail(text->file, prim.name.line, "prims are nested deeper than %d",
                        USD_MAX_DEPTH);
    if (!usd_prim_metadata(text, &prim.arc, &is_active) ||
        !usd_expect(text, '{', "the header of a prim"))
        return false;
    const bool is_left_out = parser->depth > 0 && parser->open[parser->depth - 1] == USD_NONE;
    uint32_t index = USD_NONE;
    if (!is_left_out && is_def && is_active && !has_no_surface(&prim.type)) {
        index = (uint32_t)layer->n_prims;
        if (!add_prim(layer, &prim))
            return false;
    } else if (usd_text_is(&prim.type, "Mesh")) {
        layer->n_left_out++;
    }
    parser->open[parser->depth++] = index;
    return true;
}

/* The innermost open prim, or NULL if it is left out. */
static struct usd_prim *innermost(const struct parser *parser)
{
    uint32_t index = parser->open[parser->depth - 1];
    return index == USD_NONE ? NULL : &parser->layer->prim[index];
}

/* Skips a set of variants; its prim is marked as dependent. */
static bool skip_variant_set(struct parser *parser, const struct usd_token *keyword)
{
    struct usd_token name;
    struct usd_prim *prim = innermost(parser);
    if (prim && !prim->arc.what) {
        prim->arc.what = "variants";
        prim->arc.line = keyword->line;
    }
    return usd_string(&parser->text, "variantSet", &name) &&
           usd_expect(&parser->text, '=', "the name of a variantSet") &&
           usd_skip_value(&parser->text, NULL) && usd_skip_metadata(&parser->text);
}

/* Skips what a `reorder` statement says after its keyword. */
static bool skip_reorder(struct usd_text *text)
{
    struct usd_token what;
    return usd_next(text, &what) && usd_expect(text, '=', "reorder") && usd_skip_value(text, NULL);
}

/* True for words before the type of a property. */
static bool is_before_type(const struct usd_token *token)
{
    static const char *const words[] = {"custom", "uniform", "varying", "config",
                                        "add",    "append",  "prepend", "delete"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (usd_is_word(token, words[i]))
            return true;
    return false;
}

/* Reads a property, whose first token was read: words before the type, the type, the name, the
 * value. */
static bool read_property(struct parser *parser, struct usd_token token)
{
    struct usd_text *text = &parser->text;
    bool is_array;
    while (is_before_type(&token))
        if (!usd_next(text, &token))
            return false;
    if (token.kind != USD_WORD)
        return usd_fail(text->file, token.line, "'%.*s' stands where a property or a prim must",
                        USD_SHOWN(&token));
    struct usd_token name;
    if (!usd_next_is(text, '[', &is_array) ||
        (is_array && !usd_expect(text, ']', "the '[' of a type")) || !usd_next(text, &name))
        return false;
    if (name.kind != USD_WORD)
        return usd_fail(text->file, name.line, "'%.*s' needs the name of a property, not '%.*s'",
                        USD_SHOWN(&token), USD_SHOWN(&name));
    return usd_layer_property(parser->layer, innermost(parser), text, &name);
}

static bool is_specifier(const struct usd_token *token)
{
    return usd_is_word(token, "def") || usd_is_word(token, "over") || usd_is_word(token, "class");
}

/* Reads one statement, whose first token was read. */
static bool read_statement(struct parser *parser, const struct usd_token *token)
{
    if (is_specifier(token))
        return open_prim(parser, token);
    if (usd_is_word(token, "reorder"))
        return skip_reorder(&parser->text);
    if (parser->depth == 0)
        return usd_fail(parser->text.file, token->line,
                        "'%.*s' stands where def, over or class must", USD_SHOWN(token));
    if (usd_is_sign(token, '}')) {
        parser->depth--;
        return true;
    }
    if (usd_is_word(token, "variantSet"))
        return skip_variant_set(parser, token);
    return read_property(parser, *token);
}

bool usd_layer_read(struct usd_layer *layer, struct usd_text *text)
{
    struct parser parser = {.layer = layer, .text = *text};
    struct usd_token token;
    layer->file = text->file;
    layer->up = CAGE_UP_Y; /* what USD says if a file does not */
    if (!usd_layer_metadata(layer, &parser.text))
        return false;
    for (;;) {
        if (!usd_next(&parser.text, &token))
            return false;
        if (token.kind == USD_END)
            break;
        if (!read_statement(&parser, &token))
            return false;
    }
    return parser.depth == 0 ||
           usd_fail(text->file, token.line, "the file ends within %u open prim%s: is it cut off?",
                    parser.depth, parser.depth == 1 ? "" : "s");
}
