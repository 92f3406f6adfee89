#include "server/cage/read/usd/settings.h"

bool usd_read_settings(struct usd_settings *settings, const struct usd_values *values,
                       const struct usd_file *file)
{
    static const char *const schemes[] = {"catmullClark", "loop", "bilinear", "none"};
    static const char *const boundaries[] = {"edgeOnly", "edgeAndCorner", "none"};
    static const char *const rules[] = {"catmullClark", "smooth"};
    static const char *const orientations[] = {"rightHanded", "leftHanded"};
    size_t scheme = 0, boundary = 1, rule = 0, orientation = 0;
    if (!usd_choose(values, USD_SUBDIVISION_SCHEME, schemes, 4,
                    "catmullClark, loop, bilinear, none", &scheme) ||
        !usd_choose(values, USD_INTERPOLATE_BOUNDARY, boundaries, 3,
                    "none, edgeOnly, edgeAndCorner", &boundary) ||
        !usd_choose(values, USD_TRIANGLE_RULE, rules, 2, "catmullClark, smooth", &rule) ||
        !usd_choose(values, USD_ORIENTATION, orientations, 2, "rightHanded, leftHanded",
                    &orientation))
        return false;
    if (scheme == 3)
        return usd_fail(file, values->property[USD_SUBDIVISION_SCHEME]->name.line,
                        "Mesh '%.*s' has subdivisionScheme none: it is a polygon mesh and no cage; "
                        "export it with its subdivision scheme, or hide it",
                        USD_SHOWN(&values->prim->name));
    *settings = (struct usd_settings){(enum cage_scheme)scheme, (enum cage_boundary)boundary,
                                      rule == 1, orientation == 1};
    return true;
}

static bool differ(const struct usd_shared *shared, const char *what, const struct usd_prim *prim,
                   uint32_t line)
{
    return usd_fail(shared->file, prim->name.line,
                    "%s of Mesh '%.*s' differs from that of the mesh in line %u, and a model has "
                    "one: write a file for each",
                    what, USD_SHOWN(&prim->name), line);
}

static bool share_scheme(struct usd_shared *shared, const struct usd_prim *prim,
                         const struct usd_settings *settings)
{
    struct cage *cage = shared->cage;
    if (shared->scheme.is && cage->scheme != settings->scheme)
        return differ(shared, "subdivisionScheme", prim, shared->scheme.line);
    shared->scheme = (struct usd_given){true, prim->name.line};
    cage->scheme = settings->scheme;
    return true;
}

static bool share_boundary(struct usd_shared *shared, const struct usd_prim *prim,
                           const struct usd_settings *settings)
{
    struct cage *cage = shared->cage;
    if (!shared->boundary.is) {
        shared->boundary = (struct usd_given){true, prim->name.line};
        cage->boundary = settings->boundary;
        return true;
    }
    if ((settings->boundary == CAGE_BOUNDARY_NONE) != (cage->boundary == CAGE_BOUNDARY_NONE))
        return differ(shared, "interpolateBoundary", prim, shared->boundary.line);
    if (settings->boundary != cage->boundary) {
        shared->mixed_boundaries = true;
        cage->boundary = CAGE_BOUNDARY_EDGE_ONLY;
    }
    return true;
}

bool usd_share_settings(struct usd_shared *shared, const struct usd_prim *prim,
                        const struct usd_settings *settings)
{
    return share_scheme(shared, prim, settings) && share_boundary(shared, prim, settings);
}

bool usd_share_triangle_rule(struct usd_shared *shared, const struct usd_prim *prim, bool smooth,
                             bool has_triangle)
{
    struct cage *cage = shared->cage;
    struct usd_given *own = smooth ? &shared->smooth_triangles : &shared->catmull_clark_triangles;
    const struct usd_given *other =
        smooth ? &shared->catmull_clark_triangles : &shared->smooth_triangles;
    if (has_triangle && other->is)
        return differ(shared, "triangleSubdivisionRule", prim, other->line);
    if (has_triangle && !own->is)
        *own = (struct usd_given){true, prim->name.line};
    cage->smooth_triangles = shared->smooth_triangles.is || (!shared->catmull_clark_triangles.is &&
                                                             (cage->smooth_triangles || smooth));
    return true;
}
