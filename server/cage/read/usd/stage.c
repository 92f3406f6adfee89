#include "server/cage/read/usd/stage.h"

#include "server/cage/read/usd/mesh.h"
#include "server/cage/read/usd/settings.h"

enum purpose { PURPOSE_DEFAULT, PURPOSE_RENDER, PURPOSE_PROXY, PURPOSE_GUIDE };

/* What a prim hands to those in it. */
struct state {
    struct transform world;
    bool is_placed; /* false: `world` is the identity, and was never multiplied */
    /* The innermost op of `world` that varies over time; NULL: none does. */
    const struct usd_property *varying_op;
    bool hidden;
    enum purpose purpose;
};

/* A count of what is passed over, and the first of it. */
struct tally {
    uint32_t count, line;
    struct usd_token first;
};

struct stage {
    struct cage_builder *builder;
    const struct usd_layer *layer;
    const struct usd_file *file;
    /* The open prims; state[0] is around them all. */
    struct state state[USD_MAX_DEPTH + 1];
    struct tally hidden, purposes, other, empty, sampled, skins, unplaced, unknown_ops;
    struct usd_shared shared;
    bool has_negative;
};

static void tally(struct tally *tally, const struct usd_token *first)
{
    if (tally->count++ == 0) {
        tally->line = first->line;
        tally->first = *first;
    }
}

static bool is_type(const struct usd_prim *prim, const char *type)
{
    return usd_text_is(&prim->type, type);
}

/* Geometry that is drawn elsewhere and is no cage. */
static bool is_other_geometry(const struct usd_prim *prim)
{
    static const char *const types[] = {
        "BasisCurves", "HermiteCurves", "NurbsCurves", "NurbsPatch", "Points",     "TetMesh",
        "Volume",      "Sphere",        "Cube",        "Cone",       "Cylinder",   "Capsule",
        "Plane",       "Cylinder_1",    "Capsule_1",   "Text",       "SimpleText",
    };
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (is_type(prim, types[i]))
            return true;
    return false;
}

/* Prims without a type, and scopes, have no transform (UsdGeomXformable). */
static bool has_transform(const struct usd_prim *prim)
{
    return prim->type.length > 0 && !is_type(prim, "Scope");
}

/* --- what a prim inherits and hands on */

/* True if visibility is "invisible"; any other value hides nothing (UsdGeomImageable). */
static bool is_invisible(const struct usd_values *values, bool *is)
{
    struct usd_text text = usd_value(values, USD_VISIBILITY);
    struct usd_token token;
    if (text.at && !usd_next(&text, &token))
        return false;
    *is = text.at && usd_text_is(&token, "invisible");
    return true;
}

static bool read_visibility(struct state *state, const struct usd_values *values)
{
    static const char *const purposes[] = {"default", "render", "proxy", "guide"};
    size_t purpose = state->purpose;
    bool invisible;
    if (!is_invisible(values, &invisible) ||
        !usd_choose(values, USD_PURPOSE, purposes, 4, "default, render, proxy, guide", &purpose))
        return false;
    state->hidden |= invisible;
    state->purpose = (enum purpose)purpose;
    return true;
}

/* Refuses what would take content from elsewhere, in a part that is drawn. */
static bool check_arc(const struct stage *stage, const struct usd_prim *prim)
{
    return !prim->arc.what ||
           usd_fail(stage->file, prim->arc.line,
                    "'%.*s' takes content from elsewhere by %s, which is not read: write a file of "
                    "its own by usdcat --flatten%s",
                    USD_SHOWN(&prim->name), prim->arc.what,
                    prim->arc.is_instance ? ", after instanceable = true was removed" : "");
}

static const struct usd_property *find_varying_op(const struct usd_values *values)
{
    for (size_t i = 0; i < values->n_ops; i++)
        if (values->op[i]->source == USD_SAMPLE)
            return values->op[i];
    return NULL;
}

static bool place(struct stage *stage, struct state *state, const struct usd_values *values)
{
    struct usd_xform xform;
    if (!values->property[USD_XFORM_OP_ORDER])
        return true;
    if (!has_transform(values->prim)) {
        tally(&stage->unplaced, &values->prim->name);
        return true;
    }
    if (!usd_xform(&xform, values, stage->file))
        return false;
    if (xform.unknown.length > 0)
        tally(&stage->unknown_ops, &xform.unknown);
    const struct usd_property *varying_op = find_varying_op(values);
    if (varying_op || xform.resets)
        state->varying_op = varying_op;
    if (xform.resets) {
        state->world = xform.matrix;
        state->is_placed = !xform.is_identity;
    } else if (!xform.is_identity) {
        state->world =
            state->is_placed ? transform_multiply(&state->world, &xform.matrix) : xform.matrix;
        state->is_placed = true;
    }
    return true;
}

/* --- the walk */

static bool has_faces(const struct usd_values *values)
{
    return values->property[USD_POINTS] && values->property[USD_FACE_VERTEX_COUNTS] &&
           values->property[USD_FACE_VERTEX_INDICES];
}

/* Counts the properties of a mesh that vary over time, and one for its place. */
static void tally_samples(struct stage *stage, const struct usd_values *values,
                          const struct state *state)
{
    for (size_t k = 0; k < N_USD_PROPERTIES; k++)
        if (values->property[k] && values->property[k]->source == USD_SAMPLE)
            tally(&stage->sampled, &values->property[k]->name);
    if (state->varying_op)
        tally(&stage->sampled, &state->varying_op->name);
}

/* Looks at a mesh before any is added: what all must share. */
static bool survey_mesh(struct stage *stage, const struct usd_values *values,
                        const struct state *state)
{
    (void)state;
    struct usd_settings settings;
    return usd_read_settings(&settings, values, stage->file) &&
           usd_share_settings(&stage->shared, values->prim, &settings);
}

static bool build_mesh(struct stage *stage, const struct usd_values *values,
                       const struct state *state)
{
    struct usd_settings settings;
    if (!usd_read_settings(&settings, values, stage->file))
        return false;
    const bool mirrored = state->is_placed && transform_determinant(&state->world) < 0;
    struct usd_mesh mesh = {
        .values = values,
        .file = stage->file,
        .builder = stage->builder,
        .world = &state->world,
        .is_placed = state->is_placed,
        .turn_faces = settings.left_handed != mirrored,
        .sharp_corners =
            stage->shared.mixed_boundaries && settings.boundary == CAGE_BOUNDARY_EDGE_AND_CORNER,
        .has_negative = &stage->has_negative,
    };
    return usd_add_mesh(&mesh) &&
           usd_share_triangle_rule(&stage->shared, values->prim, settings.smooth_triangles,
                                   mesh.has_triangle);
}

typedef bool visit_mesh(struct stage *, const struct usd_values *, const struct state *);

/* Visits the mesh of a prim that is drawn; counts what is passed over. */
static bool visit_drawn(struct stage *stage, const struct usd_values *values,
                        const struct state *state, visit_mesh *visit)
{
    const struct usd_prim *prim = values->prim;
    if (!check_arc(stage, prim))
        return false;
    if (is_type(prim, "PointInstancer"))
        return usd_fail(stage->file, prim->name.line,
                        "PointInstancer '%.*s' is not read: export its instances as meshes of "
                        "their own",
                        USD_SHOWN(&prim->name));
    if (is_type(prim, "SkelRoot"))
        tally(&stage->skins, &prim->name);
    if (is_other_geometry(prim))
        tally(&stage->other, &prim->name);
    if (!is_type(prim, "Mesh"))
        return true;
    tally_samples(stage, values, state);
    if (has_faces(values))
        return visit(stage, values, state);
    tally(&stage->empty, &prim->name);
    return true;
}

static bool visit_prim(struct stage *stage, const struct usd_prim *prim, visit_mesh *visit)
{
    struct usd_values values;
    struct state *state = &stage->state[prim->depth + 1];
    *state = stage->state[prim->depth];
    if (!state->hidden &&
        (!usd_find_values(&values, stage->layer, prim) || !read_visibility(state, &values)))
        return false;
    if (state->hidden) {
        if (is_type(prim, "Mesh"))
            tally(&stage->hidden, &prim->name);
        return true;
    }
    if (!place(stage, state, &values))
        return false;
    if (state->purpose == PURPOSE_PROXY || state->purpose == PURPOSE_GUIDE) {
        if (is_type(prim, "Mesh"))
            tally(&stage->purposes, &prim->name);
        return true;
    }
    return visit_drawn(stage, &values, state, visit);
}

static bool walk(struct stage *stage, visit_mesh *visit)
{
    stage->state[0] = (struct state){.world = transform_identity()};
    for (size_t i = 0; i < stage->layer->n_prims; i++)
        if (!visit_prim(stage, &stage->layer->prim[i], visit))
            return false;
    return true;
}

/* --- warnings */

static void warn(struct stage *stage, const struct tally *tally, const char *what)
{
    if (tally->count == 1)
        cage_warn(&stage->builder->cage, "%s:%u: %s: '%.*s'", stage->file->name, tally->line, what,
                  USD_SHOWN(&tally->first));
    else if (tally->count > 1)
        cage_warn(&stage->builder->cage, "%s:%u: %s: %u, the first is '%.*s'", stage->file->name,
                  tally->line, what, tally->count, USD_SHOWN(&tally->first));
}

static void add_warnings(struct stage *stage)
{
    struct cage *cage = &stage->builder->cage;
    warn(stage, &stage->sampled, "properties vary over time, and the earliest time is shown");
    warn(stage, &stage->skins, "skins are passed over, the cage stands in its bind pose");
    warn(stage, &stage->hidden, "invisible meshes are passed over");
    warn(stage, &stage->purposes, "meshes of purpose guide or proxy are passed over");
    warn(stage, &stage->other, "geometry that is no Mesh is passed over");
    warn(stage, &stage->empty, "meshes without points or faces are passed over");
    warn(stage, &stage->unplaced,
         "xformOpOrder has no effect on a prim without a type and on a Scope");
    warn(stage, &stage->unknown_ops, "entries of xformOpOrder without a property are passed over");
    if (stage->layer->n_left_out > 0)
        cage_warn(cage, "%s: meshes in prims that are inactive, over or class are passed over: %u",
                  stage->file->name, stage->layer->n_left_out);
    if (stage->has_negative)
        cage_warn(cage, "%s: a sharpness below 0 counts as 0", stage->file->name);
}

/* Refuses a stage without faces, with the reason if it is known. */
static bool check_faces(const struct stage *stage)
{
    const struct usd_file *file = stage->file;
    if (stage->builder->cage.n_faces > 0)
        return true;
    const struct {
        const struct tally *tally;
        const char *why;
    } reasons[] = {
        {&stage->empty, "no mesh has points and faces; the first without is"},
        {&stage->hidden, "all meshes are invisible; the first is"},
        {&stage->purposes, "all meshes are of purpose guide or proxy; the first is"},
        {&stage->other, "no geometry is a Mesh; the first that is not is"},
    };
    for (size_t i = 0; i < sizeof reasons / sizeof *reasons; i++)
        if (reasons[i].tally->count > 0)
            return usd_fail(file, reasons[i].tally->line, "%s '%.*s'", reasons[i].why,
                            USD_SHOWN(&reasons[i].tally->first));
    return error_set(file->error, ERROR_MODEL,
                     stage->layer->n_left_out > 0
                         ? "%s: all meshes are in prims that are inactive, over or class"
                         : "%s: it has no prim of type Mesh, so it makes no surface",
                     file->name);
}

bool usd_stage_build(struct cage_builder *builder, const struct usd_layer *layer)
{
    struct stage stage = {.builder = builder,
                          .layer = layer,
                          .file = layer->file,
                          .shared = {.cage = &builder->cage, .file = layer->file}};
    builder->cage.up = layer->up;
    if (!walk(&stage, survey_mesh))
        return false;
    /* The second walk counts again what is passed over. */
    const struct tally none = {0};
    stage.hidden = stage.purposes = stage.other = stage.empty = stage.sampled = none;
    stage.skins = stage.unplaced = stage.unknown_ops = none;
    if (!walk(&stage, build_mesh) || !check_faces(&stage))
        return false;
    add_warnings(&stage);
    return true;
}
