#include "server/cage/read/usd/xform.h"

#include <math.h>

/* What the last column of a matrix may differ from 0 0 0 1 by: the rounding of products in double
 * precision, which some programs leave there. */
#define MATRIX_ROUNDING 1e-12

/* One entry of xformOpOrder. */
struct op {
    const struct usd_file *file;
    struct usd_token name; /* without "!invert!" */
    struct usd_text value;
    bool inverted;
};

/* --- numbers to matrices */

/* The sine and cosine of an angle in degrees, exact at multiples of 90. */
static void sine_cosine(double degrees, double *sine, double *cosine)
{
    double rest = remainder(degrees, 360); /* from -180 to 180, exact */
    double quarter = round(rest / 90);
    double angle = (rest - 90 * quarter) * (M_PI / 180);
    const double s = sin(angle), c = cos(angle);
    switch ((int)quarter & 3) {
    case 0:
        *sine = s, *cosine = c;
        break;
    case 1:
        *sine = c, *cosine = -s;
        break;
    case 2:
        *sine = -s, *cosine = -c;
        break;
    default:
        *sine = -c, *cosine = s;
    }
}

/* The rotation about an axis, 0 to 2, by an angle in degrees. */
static struct transform rotation(int axis, double degrees)
{
    struct transform t = transform_identity();
    int a = (axis + 1) % 3, b = (axis + 2) % 3;
    double sine, cosine;
    sine_cosine(degrees, &sine, &cosine);
    t.m[4 * a + a] = cosine;
    t.m[4 * a + b] = sine;
    t.m[4 * b + a] = -sine;
    t.m[4 * b + b] = cosine;
    return t;
}

static void apply_first(struct transform *t, const struct transform *first)
{
    *t = transform_multiply(t, first);
}

/* The rotations about three axes in the order of `axes`, such as "XYZ": X first. */
static struct transform rotations(const char *axes, const double degrees[3])
{
    struct transform t = transform_identity();
    for (int i = 2; i >= 0; i--) {
        const struct transform one = rotation(axes[i] - 'X', degrees[axes[i] - 'X']);
        apply_first(&t, &one);
    }
    return t;
}

/* The inverse; false if there is none in double precision. */
static bool invert(struct transform *t)
{
    const double *m = t->m, determinant = transform_determinant(t);
    struct transform inverse = transform_identity();
    if (!isfinite(1 / determinant))
        return false;
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 3; column++) {
            int a = (column + 1) % 3, b = (column + 2) % 3, c = (row + 1) % 3, d = (row + 2) % 3;
            inverse.m[4 * column + row] =
                (m[4 * c + a] * m[4 * d + b] - m[4 * d + a] * m[4 * c + b]) / determinant;
        }
    }
    for (int row = 0; row < 3; row++)
        for (int k = 0; k < 3; k++)
            inverse.m[12 + row] -= inverse.m[4 * k + row] * m[12 + k];
    *t = inverse;
    for (int i = 0; i < 16; i++)
        if (!isfinite(t->m[i]))
            return false;
    return true;
}

/* --- the kinds of ops */

static bool read_translate(struct op *op, struct transform *t)
{
    return usd_tuple(&op->value, "translate", 3, &t->m[12]);
}

static bool read_scale(struct op *op, struct transform *t)
{
    double scale[3];
    if (!usd_tuple(&op->value, "scale", 3, scale))
        return false;
    for (int i = 0; i < 3; i++)
        t->m[5 * i] = scale[i];
    return true;
}

/* A quaternion, its real part first, of any length. */
static bool read_orient(struct op *op, struct transform *t)
{
    static const double origin[3] = {0, 0, 0}, one[3] = {1, 1, 1};
    double q[4];
    if (!usd_tuple(&op->value, "orient", 4, q))
        return false;
    *t = transform_compose(origin, (const double[4]){q[1], q[2], q[3], q[0]}, one);
    return true;
}

/* Four rows in parentheses, for points as rows: the numbers have the order of struct transform. */
static bool read_matrix(struct op *op, struct transform *t)
{
    static const double last[4] = {0, 0, 0, 1};
    const uint32_t line = op->value.line;
    for (int row = 0; row < 4; row++)
        if (!usd_expect(&op->value, row ? ',' : '(', row ? "a row of a matrix" : "transform") ||
            !usd_tuple(&op->value, "a row of a matrix", 4, &t->m[4 * row]))
            return false;
    for (int row = 0; row < 4; row++) {
        if (!(fabs(t->m[4 * row + 3] - last[row]) <= MATRIX_ROUNDING))
            return usd_fail(op->file, line, "the last column of transform must be 0 0 0 1");
        t->m[4 * row + 3] = last[row];
    }
    return usd_expect(&op->value, ')', "the last row of a matrix");
}

/* rotateX to rotateZ, translateX to translateZ, scaleX to scaleZ. */
static bool read_single(struct op *op, const char *kind, int axis, struct transform *t)
{
    double number;
    if (!usd_number(&op->value, kind, &number))
        return false;
    if (*kind == 'r')
        *t = rotation(axis, number);
    else
        t->m[*kind == 't' ? 12 + axis : 5 * axis] = number;
    return true;
}

static bool read_rotations(struct op *op, const char *axes, struct transform *t)
{
    double degrees[3];
    if (!usd_tuple(&op->value, "a rotation", 3, degrees))
        return false;
    *t = rotations(axes, degrees);
    return true;
}

/* The kind of an op: the part of its name between "xformOp:" and the next ':'. */
static struct usd_token op_kind(const struct op *op)
{
    struct usd_token kind = op->name;
    const size_t prefix = strlen("xformOp:");
    kind.text += prefix;
    kind.length -= prefix;
    const char *end = memchr(kind.text, ':', kind.length);
    if (end)
        kind.length = (size_t)(end - kind.text);
    return kind;
}

static bool read_op(struct op *op, struct transform *t)
{
    static const char *const single[] = {"rotate", "translate", "scale"};
    static const char *const orders[] = {"XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"};
    const struct usd_token kind = op_kind(op);
    *t = transform_identity();
    if (usd_text_is(&kind, "translate"))
        return read_translate(op, t);
    if (usd_text_is(&kind, "scale"))
        return read_scale(op, t);
    if (usd_text_is(&kind, "orient"))
        return read_orient(op, t);
    if (usd_text_is(&kind, "transform"))
        return read_matrix(op, t);
    for (size_t i = 0; i < sizeof single / sizeof *single; i++) {
        size_t n = strlen(single[i]);
        if (kind.length == n + 1 && memcmp(kind.text, single[i], n) == 0 && kind.text[n] >= 'X' &&
            kind.text[n] <= 'Z')
            return read_single(op, single[i], kind.text[n] - 'X', t);
    }
    for (size_t i = 0; i < sizeof orders / sizeof *orders; i++)
        if (kind.length == 9 && memcmp(kind.text, "rotate", 6) == 0 &&
            memcmp(kind.text + 6, orders[i], 3) == 0)
            return read_rotations(op, orders[i], t);
    return usd_fail(op->file, op->name.line, "'%.*s' is no xformOp that is known",
                    USD_SHOWN(&op->name));
}

/* --- the order of ops */

static const struct usd_property *find_op(const struct usd_values *values,
                                          const struct usd_token *name)
{
    for (size_t i = 0; i < values->n_ops; i++)
        if (values->op[i]->name.length == name->length &&
            memcmp(values->op[i]->name.text, name->text, name->length) == 0)
            return values->op[i];
    return NULL;
}

/* Takes a beginning from a text, if it has it. */
static bool take_beginning(struct usd_token *token, const char *beginning)
{
    size_t n = strlen(beginning);
    if (token->length < n || memcmp(token->text, beginning, n) != 0)
        return false;
    token->text += n;
    token->length -= n;
    return true;
}

static bool add_op(struct usd_xform *xform, const struct usd_values *values,
                   const struct usd_file *file, struct usd_token entry)
{
    struct transform t;
    struct op op = {.file = file, .inverted = take_beginning(&entry, "!invert!")};
    op.name = entry;
    const struct usd_property *property = find_op(values, &entry);
    if (!property) {
        if (xform->unknown.length == 0)
            xform->unknown = entry;
        return true;
    }
    op.value = property->value;
    if (!read_op(&op, &t))
        return false;
    if (op.inverted && !invert(&t))
        return usd_fail(file, property->name.line, "'%.*s' has no inverse", USD_SHOWN(&entry));
    apply_first(&xform->matrix, &t);
    xform->is_identity = false;
    return true;
}

bool usd_xform(struct usd_xform *xform, const struct usd_values *values,
               const struct usd_file *file)
{
    const struct usd_text order = usd_value(values, USD_XFORM_OP_ORDER);
    struct usd_list list;
    struct usd_token entry;
    bool more;
    *xform = (struct usd_xform){.matrix = transform_identity(), .is_identity = true};
    if (!usd_list_begin(&list, &order, "xformOpOrder"))
        return false;
    for (int n = 0;; n++) {
        if (!usd_list_next(&list, &more))
            return false;
        if (!more)
            return true;
        if (!usd_string(&list.text, "xformOpOrder", &entry))
            return false;
        if (n == USD_MAX_OPS)
            return usd_fail(file, entry.line, "more than %d entries of xformOpOrder are not read",
                            USD_MAX_OPS);
        if (usd_text_is(&entry, "!resetXformStack!")) {
            /* What stands before it does not count either. */
            xform->matrix = transform_identity();
            xform->is_identity = xform->resets = true;
        } else if (!add_op(xform, values, file, entry)) {
            return false;
        }
    }
}
