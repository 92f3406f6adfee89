#include "server/cage/read/usd/layer.h"

#include <stdlib.h>

static const char *const NAMES[N_USD_PROPERTIES] = {
    [USD_POINTS] = "points",
    [USD_FACE_VERTEX_COUNTS] = "faceVertexCounts",
    [USD_FACE_VERTEX_INDICES] = "faceVertexIndices",
    [USD_SUBDIVISION_SCHEME] = "subdivisionScheme",
    [USD_INTERPOLATE_BOUNDARY] = "interpolateBoundary",
    [USD_TRIANGLE_RULE] = "triangleSubdivisionRule",
    [USD_ORIENTATION] = "orientation",
    [USD_CREASE_INDICES] = "creaseIndices",
    [USD_CREASE_LENGTHS] = "creaseLengths",
    [USD_CREASE_SHARPNESSES] = "creaseSharpnesses",
    [USD_CORNER_INDICES] = "cornerIndices",
    [USD_CORNER_SHARPNESSES] = "cornerSharpnesses",
    [USD_HOLE_INDICES] = "holeIndices",
    [USD_VISIBILITY] = "visibility",
    [USD_PURPOSE] = "purpose",
    [USD_XFORM_OP_ORDER] = "xformOpOrder",
};

#define OP "xformOp:"

/* False: the name is of no property that makes a cage. */
static bool find_kind(const struct usd_token *name, enum usd_property_kind *kind)
{
    for (int k = 0; k < N_USD_PROPERTIES; k++) {
        *kind = (enum usd_property_kind)k;
        if (usd_text_is(name, NAMES[k]))
            return true;
    }
    *kind = USD_XFORM_OP;
    return name->length > strlen(OP) && memcmp(name->text, OP, strlen(OP)) == 0;
}

/* Takes an ending such as ".timeSamples" from a name, if it has it. */
static bool take_ending(struct usd_token *name, const char *ending)
{
    size_t n = strlen(ending);
    if (name->length <= n || memcmp(name->text + name->length - n, ending, n) != 0)
        return false;
    name->length -= n;
    return true;
}

static struct usd_property *new_property(struct usd_layer *layer)
{
    if (layer->n_properties == layer->property_capacity) {
        size_t wanted = layer->property_capacity ? 2 * layer->property_capacity : 64;
        struct usd_property *grown = realloc(layer->property, wanted * sizeof *grown);
        if (!grown)
            return NULL;
        layer->property = grown;
        layer->property_capacity = wanted;
    }
    return &layer->property[layer->n_properties++];
}

static bool keep(struct usd_layer *layer, struct usd_prim *prim,
                 const struct usd_property *property)
{
    const struct usd_file *file = layer->file;
    const uint32_t index = (uint32_t)layer->n_properties;
    if (index == USD_MAX_PROPERTIES)
        return usd_fail(file, property->name.line, "more than %d properties of meshes are not read",
                        USD_MAX_PROPERTIES);
    struct usd_property *kept = new_property(layer);
    if (!kept)
        return error_set(file->error, ERROR_SERVER, "%s: not enough memory for %u properties",
                         file->name, index);
    *kept = *property;
    kept->next = USD_NONE;
    if (prim->first_property == USD_NONE)
        prim->first_property = index;
    else
        layer->property[prim->last_property].next = index;
    prim->last_property = index;
    return true;
}

/* Skips "{ time: value, ... }" and sets *value to the value of the earliest time. value->at is NULL
 * if there is none, or if it is None or []. */
static bool find_earliest(struct usd_text *text, struct usd_text *value)
{
    double earliest = 0, time;
    bool found = false, is_end, is_empty;
    value->at = NULL;
    if (!usd_expect(text, '{', ".timeSamples ="))
        return false;
    for (;;) {
        if (!usd_next_is(text, '}', &is_end))
            return false;
        if (is_end)
            return true;
        if (!usd_number(text, "a time of timeSamples", &time) ||
            !usd_expect(text, ':', "a time of timeSamples"))
            return false;
        const struct usd_text start = *text;
        if (!usd_skip_value(text, &is_empty))
            return false;
        if (!found || time < earliest) {
            *value = start;
            if (is_empty)
                value->at = NULL;
            earliest = time;
            found = true;
        }
        if (!usd_next_is(text, ',', &is_end))
            return false;
    }
}

bool usd_layer_property(struct usd_layer *layer, struct usd_prim *prim, struct usd_text *text,
                        const struct usd_token *name)
{
    struct usd_property property = {.name = *name, .value = {.at = NULL}};
    bool has_value, is_empty = false;
    if (!usd_next_is(text, '=', &has_value))
        return false;
    if (has_value) {
        property.value = *text;
        if (take_ending(&property.name, ".timeSamples"))
            property.source = USD_SAMPLE;
        else if (take_ending(&property.name, ".spline"))
            property.source = USD_SPLINE;
        if (property.source == USD_SAMPLE ? !find_earliest(text, &property.value)
                                          : !usd_skip_value(text, &is_empty))
            return false;
    }
    if (!usd_skip_metadata(text))
        return false;
    if (is_empty || !property.value.at || !prim || !find_kind(&property.name, &property.kind))
        return true;
    return keep(layer, prim, &property);
}
