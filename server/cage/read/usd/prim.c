#include "server/cage/read/usd/prim.h"

#include <stdio.h>

/* True if the earlier of two properties of one name counts. */
static bool earlier_counts(const struct usd_property *earlier, const struct usd_property *later)
{
    return earlier->source == USD_DEFAULT && later->source != USD_DEFAULT;
}

static bool same_name(const struct usd_property *a, const struct usd_property *b)
{
    return a->name.length == b->name.length &&
           memcmp(a->name.text, b->name.text, a->name.length) == 0;
}

static bool keep_op(struct usd_values *values, const struct usd_file *file,
                    const struct usd_property *property)
{
    for (size_t i = 0; i < values->n_ops; i++) {
        if (!same_name(values->op[i], property))
            continue;
        if (!earlier_counts(values->op[i], property))
            values->op[i] = property;
        return true;
    }
    if (values->n_ops == USD_MAX_OPS)
        return usd_fail(file, property->name.line, "more than %d xformOps of a prim are not read",
                        USD_MAX_OPS);
    values->op[values->n_ops++] = property;
    return true;
}

static bool check_source(const struct usd_file *file, const struct usd_property *property)
{
    return !property || property->source != USD_SPLINE ||
           usd_fail(file, property->name.line,
                    "%.*s is given by a spline, which is not read: give it a value",
                    USD_SHOWN(&property->name));
}

bool usd_find_values(struct usd_values *values, const struct usd_layer *layer,
                     const struct usd_prim *prim)
{
    const struct usd_property *property;
    *values = (struct usd_values){.prim = prim};
    for (uint32_t i = prim->first_property; i != USD_NONE; i = property->next) {
        property = &layer->property[i];
        if (property->kind == USD_XFORM_OP) {
            if (!keep_op(values, layer->file, property))
                return false;
            continue;
        }
        const struct usd_property **kept = &values->property[property->kind];
        if (!*kept || !earlier_counts(*kept, property))
            *kept = property;
    }
    for (size_t k = 0; k < N_USD_PROPERTIES; k++)
        if (!check_source(layer->file, values->property[k]))
            return false;
    for (size_t i = 0; i < values->n_ops; i++)
        if (!check_source(layer->file, values->op[i]))
            return false;
    return true;
}

struct usd_text usd_value(const struct usd_values *values, enum usd_property_kind kind)
{
    const struct usd_property *property = values->property[kind];
    return property ? property->value : (struct usd_text){.at = NULL};
}

bool usd_choose(const struct usd_values *values, enum usd_property_kind kind,
                const char *const *words, size_t n, const char *all, size_t *choice)
{
    struct usd_text text = usd_value(values, kind);
    struct usd_token token;
    char what[41];
    if (!text.at)
        return true;
    const struct usd_token *name = &values->property[kind]->name;
    snprintf(what, sizeof what, "%.*s", USD_SHOWN(name));
    if (!usd_string(&text, what, &token))
        return false;
    for (size_t i = 0; i < n; i++) {
        if (usd_text_is(&token, words[i])) {
            *choice = i;
            return true;
        }
    }
    return usd_fail(text.file, token.line, "%s is '%.*s', needs one of %s", what, USD_SHOWN(&token),
                    all);
}
