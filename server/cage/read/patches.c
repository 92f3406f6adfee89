#include "server/cage/read/patches.h"

#include <math.h>
#include <stdio.h>

#include "server/cage/build/patch_blends.h"
#include "server/cage/build/patch_forms.h"
#include "server/cage/read/words.h"

/* Sides that meet at a corner may differ there by this share of the patch's size, which is what rounded decimals do. */
#define CORNER_SLACK 1e-6

static const char *const SIDE_NAMES[N_PATCH_SIDES] = {"v=0", "v=1", "u=0", "u=1"};
static const char *const CORNER_NAMES[4] = {"(0,0)", "(1,0)", "(0,1)", "(1,1)"};

struct reading {
    struct words words;
    struct cage_builder *builder;
    bool warned_twists;
};

static bool read_bezier(struct reading *reading, struct cage_patch *patch)
{
    struct words *words = &reading->words;
    double points[16][3];
    uint32_t m, n;
    if (!words_count(words, 1, PATCH_MAX_DEGREE, &m, "the degree along u") ||
        !words_count(words, 1, PATCH_MAX_DEGREE, &n, "the degree along v") ||
        !words_points(words, points, (size_t)(m + 1) * (n + 1), "point"))
        return false;
    patch_from_bezier((const double(*)[3])points, m, n, patch->point);
    return true;
}

static bool read_bspline(struct reading *reading, struct cage_patch *patch)
{
    patch->basis = CAGE_BSPLINE;
    return words_points(&reading->words, patch->point, 16, "point");
}

/* Reads four corners of point, derivatives and, of a Hermite patch, twist. */
static bool read_corners(struct reading *reading, bool has_twists, struct cage_patch *patch)
{
    struct patch_corner corner[4];
    for (int c = 0; c < 4; c++) {
        double rows[4][3] = {{0}};
        char what[40];
        snprintf(what, sizeof what, "corner %s: row", CORNER_NAMES[c]);
        if (!words_points(&reading->words, rows, has_twists ? 4 : 3, what))
            return false;
        for (int k = 0; k < 3; k++) {
            corner[c].p[k] = rows[0][k];
            corner[c].pu[k] = rows[1][k];
            corner[c].pv[k] = rows[2][k];
            corner[c].puv[k] = rows[3][k];
        }
    }
    patch_from_hermite(corner, patch->point);
    return true;
}

static bool read_hermite(struct reading *reading, struct cage_patch *patch)
{
    return read_corners(reading, true, patch);
}

static bool read_ferguson(struct reading *reading, struct cage_patch *patch)
{
    return read_corners(reading, false, patch);
}

/* Reads four curves, each a degree and its Bezier points. */
static bool read_curves(struct reading *reading, const char *kind,
                        double curve[N_PATCH_SIDES][4][3])
{
    for (int s = 0; s < N_PATCH_SIDES; s++) {
        uint32_t degree;
        char what[60];
        snprintf(what, sizeof what, "the degree of %s %s", kind, SIDE_NAMES[s]);
        if (!words_count(&reading->words, 1, PATCH_MAX_DEGREE, &degree, what))
            return false;
        snprintf(what, sizeof what, "%s %s: point", kind, SIDE_NAMES[s]);
        if (!words_points(&reading->words, curve[s], degree + 1, what))
            return false;
        patch_raise_curve(curve[s], degree);
    }
    return true;
}

static double distance(const double a[3], const double b[3])
{
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

/* The largest distance of a side's point from the first corner. */
static double size_of(double side[N_PATCH_SIDES][4][3])
{
    double size = 0;
    for (int s = 0; s < N_PATCH_SIDES; s++)
        for (int k = 0; k < 4; k++)
            size = fmax(size, distance(side[s][k], side[SIDE_V0][0]));
    return size;
}

/* The sides that meet at corner c, along u and along v, and whether it is at their ends. */
struct meeting {
    enum patch_side along_u, along_v;
    bool u_end, v_end;
};

static struct meeting meeting_at(int c)
{
    return (struct meeting){c & 2 ? SIDE_V1 : SIDE_V0, c & 1 ? SIDE_U1 : SIDE_U0, (c & 1) != 0,
                            (c & 2) != 0};
}

static bool check_corners(struct reading *reading, double side[N_PATCH_SIDES][4][3])
{
    const double slack = CORNER_SLACK * size_of(side);
    for (int c = 0; c < 4; c++) {
        const struct meeting at = meeting_at(c);
        double apart =
            distance(side[at.along_u][at.u_end ? 3 : 0], side[at.along_v][at.v_end ? 3 : 0]);
        if (!(apart <= slack))
            return words_fail(
                &reading->words, "sides %s and %s of this Coons patch are %.3g apart at corner %s",
                SIDE_NAMES[at.along_u], SIDE_NAMES[at.along_v], apart, CORNER_NAMES[c]);
    }
    return true;
}

static void slope(double curve[4][3], bool at_end, double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = 3 * (at_end ? curve[3][k] - curve[2][k] : curve[1][k] - curve[0][k]);
}

/* At each corner the derivative across one side must be that of the other side, along which it runs. */
static bool check_slopes(struct reading *reading, double side[N_PATCH_SIDES][4][3],
                         double across[N_PATCH_SIDES][4][3])
{
    const double slack = 3 * CORNER_SLACK * size_of(side);
    for (int c = 0; c < 4; c++) {
        const struct meeting at = meeting_at(c);
        double by_u[3], by_v[3], twist[2][3];
        slope(side[at.along_u], at.u_end, by_u);
        slope(side[at.along_v], at.v_end, by_v);
        bool u_fits = distance(by_u, across[at.along_v][at.v_end ? 3 : 0]) <= slack;
        bool v_fits = distance(by_v, across[at.along_u][at.u_end ? 3 : 0]) <= slack;
        if (!u_fits || !v_fits)
            return words_fail(&reading->words,
                              "the derivative across side %s of this Coons patch is not that of "
                              "side %s at corner %s",
                              SIDE_NAMES[u_fits ? at.along_u : at.along_v],
                              SIDE_NAMES[u_fits ? at.along_v : at.along_u], CORNER_NAMES[c]);
        slope(across[at.along_u], at.u_end, twist[0]);
        slope(across[at.along_v], at.v_end, twist[1]);
        if (!(distance(twist[0], twist[1]) <= 3 * slack) && !reading->warned_twists) {
            reading->warned_twists = true;
            cage_warn(
                &reading->builder->cage,
                "%s:%u: the derivatives across both sides of a Coons patch give two twists at "
                "corner %s, and any others: their mean is taken",
                reading->words.name, reading->words.line, CORNER_NAMES[c]);
        }
    }
    return true;
}

static bool read_coons(struct reading *reading, struct cage_patch *patch)
{
    double side[N_PATCH_SIDES][4][3];
    if (!read_curves(reading, "side", side) || !check_corners(reading, side))
        return false;
    patch_from_coons(side, patch->point);
    return true;
}

static bool read_bicubic_coons(struct reading *reading, struct cage_patch *patch)
{
    double side[N_PATCH_SIDES][4][3], across[N_PATCH_SIDES][4][3];
    if (!read_curves(reading, "side", side) || !check_corners(reading, side) ||
        !read_curves(reading, "derivative across", across) || !check_slopes(reading, side, across))
        return false;
    patch_from_bicubic_coons(side, across, patch->point);
    return true;
}

static const struct {
    const char *word;
    bool (*read)(struct reading *reading, struct cage_patch *patch);
} KINDS[] = {
    {"bezier", read_bezier},     {"bspline", read_bspline}, {"hermite", read_hermite},
    {"ferguson", read_ferguson}, {"coons", read_coons},     {"coons-bicubic", read_bicubic_coons},
};

static bool read_patch(struct reading *reading, const struct obj_field *kind)
{
    struct cage_patch patch = {.basis = CAGE_BEZIER, .line = reading->words.line};
    for (size_t i = 0; i < sizeof KINDS / sizeof *KINDS; i++)
        if (obj_field_is(kind, KINDS[i].word))
            return KINDS[i].read(reading, &patch) &&
                   cage_builder_patch(reading->builder, &patch, reading->words.error);
    return words_fail(&reading->words,
                      "no kind of patch: '%.*s'; sheen draws bezier, bspline, hermite, ferguson, "
                      "coons and coons-bicubic",
                      (int)(kind->length < 40 ? kind->length : 40), kind->text);
}

static bool read_all(struct reading *reading)
{
    struct obj_field word;
    uint32_t version;
    if (!words_next(&reading->words, &word) || !obj_field_is(&word, "patches"))
        return words_fail(&reading->words,
                          "is no .patches file: it does not begin with 'patches 1'");
    if (!words_count(&reading->words, 1, 1, &version, "the version of the form"))
        return false;
    while (words_next(&reading->words, &word))
        if (!read_patch(reading, &word))
            return false;
    return reading->builder->cage.n_patches > 0 || words_fail(&reading->words, "no patch at all");
}

bool patches_read(struct cage_builder *builder, const void *bytes, size_t size, const char *name,
                  struct error *error)
{
    struct reading reading = {.builder = builder};
    bool ok =
        words_init(&reading.words, bytes, size, name, ".patches", error) && read_all(&reading);
    words_finish(&reading.words);
    return ok;
}
