#include "server/cage/build/spline_surface.h"

#include <math.h>
#include <string.h>

#include "server/cage/build/patch_forms.h"

void spline_span(const double (*control)[3], size_t stride, unsigned p, const double *knot,
                 double a, double b, double out[4][3])
{
    for (unsigned j = 0; j <= p; j++) {
        double d[4][3];
        for (unsigned i = 0; i <= p; i++)
            memcpy(d[i], control[i * stride], sizeof d[i]);
        for (unsigned r = 1; r <= p; r++) {
            const double x = r <= p - j ? a : b; /* p - j times a, then j times b */
            for (unsigned i = p; i >= r; i--) {
                const double low = knot[i], high = knot[i + 1 + p - r];
                patch_blend((x - low) / (high - low), d[i - 1], d[i], d[i]);
            }
        }
        memcpy(out[j], d[p], sizeof d[p]);
    }
}

/* A part of one span: knot[at..at+1] is the span. */
struct part {
    size_t at;
    double a, b;
    bool is_uniform; /* the whole span, of a cubic between knots of one distance */
};

static bool is_uniform(const struct spline_axis *axis, size_t at)
{
    const double *knot = axis->knot + at, step = knot[1] - knot[0];
    if (axis->degree != 3 || axis->low > knot[0] || axis->high < knot[1])
        return false;
    for (int i = -2; i < 3; i++)
        if (!(fabs(knot[i + 1] - knot[i] - step) <= 1e-14 * step))
            return false;
    return true;
}

/* Gets the part of span `at` that belongs to the surface; false: none. */
static bool part_of(const struct spline_axis *axis, size_t at, struct part *part)
{
    *part = (struct part){.at = at,
                          .a = fmax(axis->knot[at], axis->low),
                          .b = fmin(axis->knot[at + 1], axis->high),
                          .is_uniform = is_uniform(axis, at)};
    return part->a < part->b;
}

static void make_patch(const struct spline_axis *u, const struct spline_axis *v,
                       const double (*point)[3], const struct part *pu, const struct part *pv,
                       struct cage_patch *patch)
{
    const unsigned m = u->degree, n = v->degree;
    const double(*first)[3] = point + (pv->at - n) * u->n + (pu->at - m);
    double rows[16][3], both[16][3], column[4][3];
    if (pu->is_uniform && pv->is_uniform) {
        patch->basis = CAGE_BSPLINE;
        for (size_t j = 0; j < 4; j++)
            memcpy(patch->point + 4 * j, first + j * u->n, sizeof column);
        return;
    }
    for (size_t j = 0; j <= n; j++)
        spline_span(first + j * u->n, 1, m, u->knot + pu->at - m, pu->a, pu->b, rows + j * (m + 1));
    for (size_t i = 0; i <= m; i++) {
        spline_span((const double(*)[3])rows + i, m + 1, n, v->knot + pv->at - n, pv->a, pv->b,
                    column);
        for (size_t j = 0; j <= n; j++)
            memcpy(both[j * (m + 1) + i], column[j], sizeof column[j]);
    }
    patch->basis = CAGE_BEZIER;
    patch_from_bezier((const double(*)[3])both, m, n, patch->point);
}

bool spline_surface_add(struct cage_builder *builder, const struct spline_axis *u,
                        const struct spline_axis *v, const double (*point)[3], uint32_t line,
                        struct error *error)
{
    struct part pu, pv;
    for (size_t j = v->degree; j < v->n; j++)
        for (size_t i = u->degree; part_of(v, j, &pv) && i < u->n; i++) {
            struct cage_patch patch = {.line = line};
            if (!part_of(u, i, &pu))
                continue;
            make_patch(u, v, point, &pu, &pv, &patch);
            if (!cage_builder_patch(builder, &patch, error))
                return false;
        }
    return true;
}
