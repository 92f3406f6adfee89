/* Free-form surfaces of OBJ: cstype to end (Wavefront, OBJ file format 3.0). */
#include <math.h>
#include <stdlib.h>

#include "server/cage/build/spline_surface.h"
#include "server/cage/build/patch_forms.h"
#include "server/cage/read/numbers/decimal.h"
#include "server/cage/read/obj_reader.h"

/* A range may exceed the knots by this share of them, which is what rounded decimals do. */
#define RANGE_SLACK 1e-6

static const char *const AXIS[2] = {"u", "v"};

void obj_surface_finish(struct obj_reader *reader)
{
    struct obj_surface *surface = &reader->surface;
    free(surface->point);
    for (int a = 0; a < 2; a++) {
        free(surface->knots[a].value);
        free(surface->matrix[a].value);
    }
    free(reader->weight.value);
    *surface = (struct obj_surface){.line = 0};
    reader->weight = (struct obj_numbers){0};
}

/* Doubles the room of an array that is full. False with ERROR_SERVER when memory is short. */
static bool make_room(struct obj_reader *reader, void **array, size_t n, size_t *room,
                      size_t element)
{
    if (n < *room)
        return true;
    size_t wanted = *room ? 2 * *room : 64;
    void *grown = realloc(*array, wanted * element);
    if (!grown)
        return error_set(reader->error, ERROR_SERVER, "%s: not enough memory for a surface",
                         reader->name);
    *array = grown;
    *room = wanted;
    return true;
}

bool obj_read_number(struct obj_reader *reader, const struct obj_field *field, const char *what,
                     double *number)
{
    if (decimal_read(field->text, field->length, reader->c_locale, number) != DECIMAL_OK)
        return obj_fail(reader, "%s is no finite number: '%.*s'", what, OBJ_SHOWN(field));
    return fabs(*number) <= CAGE_MAX_COORDINATE ||
           obj_fail(reader, "%s is %g, beyond the largest that is read, %g", what, *number,
                    CAGE_MAX_COORDINATE);
}

bool obj_add_number(struct obj_reader *reader, struct obj_numbers *numbers, double number)
{
    void *values = numbers->value;
    if (!make_room(reader, &values, numbers->n, &numbers->room, sizeof *numbers->value))
        return false;
    numbers->value = values;
    numbers->value[numbers->n++] = number;
    return true;
}

bool obj_read_numbers(struct obj_reader *reader, const char *what, struct obj_numbers *numbers)
{
    struct obj_field field;
    double number;
    while (obj_text_field(&reader->text, &field))
        if (!obj_read_number(reader, &field, what, &number) ||
            !obj_add_number(reader, numbers, number))
            return false;
    return true;
}

static bool read_type(struct obj_reader *reader)
{
    struct obj_surface *surface = &reader->surface;
    struct obj_field field;
    if (!obj_text_field(&reader->text, &field))
        return obj_fail(reader, "cstype has no type");
    surface->is_rational = obj_field_is(&field, "rat");
    if (surface->is_rational && !obj_text_field(&reader->text, &field))
        return obj_fail(reader, "cstype rat has no type");
    surface->type = field;
    surface->type_line = reader->line;
    return true;
}

static bool read_degrees(struct obj_reader *reader)
{
    struct obj_field field;
    reader->surface.degree[0] = reader->surface.degree[1] = 0;
    for (int a = 0; a < 2 && obj_text_field(&reader->text, &field); a++)
        if (!obj_read_number(reader, &field, "a degree of deg", &reader->surface.degree[a]))
            return false;
    return true;
}

/* What sheen draws, or a refusal by name. */
static bool check_type(const struct obj_reader *reader)
{
    const struct obj_surface *surface = &reader->surface;
    if (surface->type.length == 0)
        return obj_fail(reader, "surf comes before any cstype");
    const bool has_basis = obj_has_piece_basis(surface);
    if (!has_basis && !obj_field_is(&surface->type, "bezier") &&
        !obj_field_is(&surface->type, "bspline"))
        return obj_fail(reader,
                        "a surface of cstype %.*s (line %u): sheen draws bezier, bspline, "
                        "cardinal, taylor and bmatrix",
                        OBJ_SHOWN(&surface->type), surface->type_line);
    if (surface->is_rational && has_basis && !obj_field_is(&surface->type, "cardinal"))
        return obj_fail(reader,
                        "a rational surface of cstype rat %.*s (line %u): sheen draws rat with "
                        "bezier, bspline and cardinal",
                        OBJ_SHOWN(&surface->type), surface->type_line);
    for (int a = 0; a < 2; a++) {
        const double degree = surface->degree[a];
        if (degree == 0)
            return obj_fail(reader, "surf comes before a deg with two degrees");
        if (degree < 1 || degree > PATCH_MAX_DEGREE || degree != floor(degree))
            return obj_fail(reader,
                            "a surface of degree %.9g along %s: sheen draws degrees 1 to %d",
                            degree, AXIS[a], PATCH_MAX_DEGREE);
    }
    return true;
}

/* With equal weights a rational surface is the polynomial one of the same points. */
static bool check_weight(const struct obj_reader *reader)
{
    const struct obj_surface *surface = &reader->surface;
    const double first = obj_weight_of(reader, surface->point[0]),
                 last = obj_weight_of(reader, surface->point[surface->n_points - 1]);
    if (!(last > 0))
        return obj_fail(reader, "control point %zu has the weight %.9g, which is not above 0",
                        surface->n_points, last);
    return first == last ||
           obj_fail(reader,
                    "control point %zu has the weight %.9g, and the first one %.9g: of rational "
                    "surfaces sheen draws those whose weights are all equal",
                    surface->n_points, last, first);
}

static bool read_point(struct obj_reader *reader, const struct obj_field *field)
{
    struct obj_surface *surface = &reader->surface;
    const size_t n_vertices = reader->builder->cage.n_vertices, number = surface->n_points + 1;
    void *points = surface->point;
    int64_t index;
    if (!obj_scan_corner(field, &index))
        return obj_fail(reader, "control point %zu is not v, v/t, v//n or v/t/n: '%.*s'", number,
                        OBJ_SHOWN(field));
    if (index == 0 || index > (int64_t)n_vertices || index < -(int64_t)n_vertices)
        return obj_fail(reader,
                        "control point %zu refers to vertex %lld, but %zu vertices stand before it",
                        number, (long long)index, n_vertices);
    if (!make_room(reader, &points, surface->n_points, &surface->point_room,
                   sizeof *surface->point))
        return false;
    surface->point = points;
    surface->point[surface->n_points++] =
        (uint32_t)(index < 0 ? (int64_t)n_vertices + index : index - 1);
    return !surface->is_rational || check_weight(reader);
}

static bool begin_surface(struct obj_reader *reader)
{
    struct obj_surface *surface = &reader->surface;
    struct obj_field field;
    if (surface->line)
        return obj_fail(reader, "the surface of line %u has no end", surface->line);
    if (!check_type(reader))
        return false;
    surface->line = reader->line;
    surface->n_points = surface->knots[0].n = surface->knots[1].n = 0;
    for (int i = 0; i < 4; i++) {
        if (!obj_text_field(&reader->text, &field))
            return obj_fail(
                reader, "surf has %d numbers, needs its range: u from and to, v from and to", i);
        if (!obj_read_number(reader, &field, "a number of surf's range", &surface->range[i]))
            return false;
    }
    while (obj_text_field(&reader->text, &field))
        if (!read_point(reader, &field))
            return false;
    return true;
}

static bool read_knots(struct obj_reader *reader)
{
    struct obj_field field;
    if (!obj_text_field(&reader->text, &field) ||
        (!obj_field_is(&field, "u") && !obj_field_is(&field, "v")))
        return obj_fail(reader, "parm needs u or v");
    return obj_read_numbers(reader, "a number of parm",
                            &reader->surface.knots[obj_field_is(&field, "v")]);
}

/* --- the end of a surface */

/* Repeats the breaks between pieces, those at the ends degree + 1 times and the others `times`, so that they are the
 * knots of the same surface as a B-spline. False with ERROR_SERVER. */
static bool repeat_breaks(struct obj_reader *reader, struct obj_numbers *knots, unsigned degree,
                          unsigned times)
{
    struct obj_numbers repeated = {0};
    for (size_t i = 0; i < knots->n; i++) {
        const unsigned n = i == 0 || i == knots->n - 1 ? degree + 1 : times;
        for (unsigned k = 0; k < n; k++)
            if (!obj_add_number(reader, &repeated, knots->value[i])) {
                free(repeated.value);
                return false;
            }
    }
    free(knots->value);
    *knots = repeated;
    return true;
}

static bool check_knots(const struct obj_reader *reader, const char *axis, bool are_breaks,
                        unsigned degree, const struct obj_numbers *knots)
{
    const size_t least = are_breaks ? 2 : 2 * ((size_t)degree + 1),
                 most = are_breaks ? 1 : degree + 1;
    if (knots->n < least)
        return obj_fail(reader, "parm %s has %zu numbers, needs at least %zu", axis, knots->n,
                        least);
    size_t equal = 1;
    for (size_t i = 1; i < knots->n; i++) {
        if (knots->value[i] < knots->value[i - 1])
            return obj_fail(reader, "parm %s decreases from %.9g to %.9g", axis,
                            knots->value[i - 1], knots->value[i]);
        equal = knots->value[i] > knots->value[i - 1] ? 1 : equal + 1;
        if (equal > most)
            return obj_fail(reader, "parm %s has %.9g more than %zu time%s", axis, knots->value[i],
                            most, most == 1 ? "" : "s");
    }
    return true;
}

/* An axis as the file gives it, and as a B-spline. */
struct obj_axis {
    struct spline_axis spline;
    struct piece_basis basis;  /* of types that have one */
    size_t n_pieces, n_points; /* n_points: control points of the file along this axis */
};

/* Fills in the number of control points, and the knots from the breaks of pieces. */
static bool set_points(struct obj_reader *reader, int a, struct obj_axis *axis)
{
    struct obj_surface *surface = &reader->surface;
    struct obj_numbers *knots = &surface->knots[a];
    const unsigned degree = (unsigned)surface->degree[a];
    const bool is_bspline = obj_field_is(&surface->type, "bspline");
    if (!check_knots(reader, AXIS[a], !is_bspline, degree, knots))
        return false;
    if (is_bspline) {
        axis->n_points = knots->n - degree - 1;
        return true;
    }
    axis->n_pieces = knots->n - 1;
    if (!obj_has_piece_basis(surface)) {
        axis->n_points = axis->n_pieces * degree + 1;
        return repeat_breaks(reader, knots, degree, degree);
    }
    if (!obj_piece_basis(reader, a, &axis->basis))
        return false;
    axis->n_points = piece_basis_points(&axis->basis, axis->n_pieces);
    return repeat_breaks(reader, knots, degree, degree + 1);
}

/* Fills in an axis from deg, parm and the range. */
static bool set_axis(struct obj_reader *reader, int a, struct obj_axis *whole)
{
    struct obj_surface *surface = &reader->surface;
    struct obj_numbers *knots = &surface->knots[a];
    const unsigned degree = (unsigned)surface->degree[a];
    struct spline_axis *axis = &whole->spline;
    if (!set_points(reader, a, whole))
        return false;
    *axis = (struct spline_axis){degree, knots->n - degree - 1, knots->value, surface->range[2 * a],
                                 surface->range[2 * a + 1]};
    const double first = axis->knot[degree], last = axis->knot[axis->n];
    const double slack = RANGE_SLACK * (last - first);
    if (!(axis->low < axis->high))
        return obj_fail(reader, "surf's range of %s goes from %.9g to %.9g", AXIS[a], axis->low,
                        axis->high);
    if (!(axis->low >= first - slack && axis->high <= last + slack))
        return obj_fail(reader,
                        "surf's range of %s, %.9g to %.9g, is not within parm's, %.9g to %.9g",
                        AXIS[a], axis->low, axis->high, first, last);
    axis->low = fmax(axis->low, first);
    axis->high = fmin(axis->high, last);
    return axis->low < axis->high || obj_fail(reader, "surf's range of %s is empty", AXIS[a]);
}

/* The points of a surface whose pieces have a basis of their own become Bezier points: *points, which are freed,
 * are replaced. False with ERROR_SERVER. */
static bool convert_points(struct obj_reader *reader, const struct obj_axis *u,
                           const struct obj_axis *v, double (**points)[3])
{
    const size_t columns = u->spline.n, rows = v->spline.n;
    double(*along_u)[3] = malloc(columns * v->n_points * sizeof *along_u);
    double(*both)[3] = malloc(columns * rows * sizeof *both);
    const bool ok = along_u && both;
    for (size_t j = 0; ok && j < v->n_points; j++)
        piece_basis_row(&u->basis, u->n_pieces, (const double(*)[3]) * points + j * u->n_points, 1,
                        along_u + j * columns, 1);
    for (size_t i = 0; ok && i < columns; i++)
        piece_basis_row(&v->basis, v->n_pieces, (const double(*)[3])along_u + i, columns, both + i,
                        columns);
    free(along_u);
    free(*points);
    *points = both;
    return ok || error_set(reader->error, ERROR_SERVER, "%s: not enough memory for a surface",
                           reader->name);
}

static bool add_surface(struct obj_reader *reader, const struct obj_axis *u,
                        const struct obj_axis *v)
{
    const struct obj_surface *surface = &reader->surface;
    double(*points)[3] = malloc(surface->n_points * sizeof *points);
    if (!points)
        return error_set(reader->error, ERROR_SERVER, "%s: not enough memory for a surface",
                         reader->name);
    for (size_t i = 0; i < surface->n_points; i++)
        for (int k = 0; k < 3; k++)
            points[i][k] = reader->builder->cage.position[surface->point[i]][k];
    bool ok = (!obj_has_piece_basis(surface) || convert_points(reader, u, v, &points)) &&
              spline_surface_add(reader->builder, &u->spline, &v->spline,
                                 (const double(*)[3])points, surface->line, reader->error);
    free(points);
    return ok;
}

static bool end_surface(struct obj_reader *reader)
{
    struct obj_surface *surface = &reader->surface;
    struct obj_axis u = {.n_pieces = 0}, v = {.n_pieces = 0};
    if (!surface->line)
        return true; /* of a curve */
    if (!set_axis(reader, 0, &u) || !set_axis(reader, 1, &v))
        return false;
    if (surface->n_points != u.n_points * v.n_points)
        return obj_fail(
            reader,
            "the surface of line %u has %zu control points, but deg and parm make %zu x %zu",
            surface->line, surface->n_points, u.n_points, v.n_points);
    if (!add_surface(reader, &u, &v))
        return false;
    surface->line = 0;
    return true;
}

bool obj_end_surfaces(struct obj_reader *reader)
{
    struct cage *cage = &reader->builder->cage;
    if (reader->surface.line)
        return obj_fail(reader, "the file ends in the surface of line %u", reader->surface.line);
    if (cage->n_patches == 0)
        return true;
    if (cage->n_faces > 0) {
        reader->line = cage->patch[0].line;
        return obj_fail(reader,
                        "a surface in a file with %zu faces: sheen draws either, give each a file",
                        cage->n_faces);
    }
    /* The patches have the points. */
    free(cage->position);
    cage->position = NULL;
    cage->n_vertices = reader->builder->vertex_capacity = 0;
    return true;
}

/* Keywords that change no surface: curves, of which only trims and holes make use, and wishes for a tessellation. */
static bool is_of_curves(const struct obj_field *keyword)
{
    static const char *const words[] = {"curv",  "curv2", "con", "ctech",
                                        "stech", "mg",    "sp",  "scrv"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (obj_field_is(keyword, words[i]))
            return true;
    return false;
}

bool obj_read_surface(struct obj_reader *reader, const struct obj_field *keyword, bool *is_known)
{
    const bool is_setting = obj_field_is(keyword, "cstype") || obj_field_is(keyword, "deg") ||
                            obj_field_is(keyword, "bmat") || obj_field_is(keyword, "step");
    *is_known = true;
    if (is_setting && reader->surface.line)
        return obj_fail(reader, "%.*s within the surface of line %u, which has no end before",
                        OBJ_SHOWN(keyword), reader->surface.line);
    if (obj_field_is(keyword, "cstype"))
        return read_type(reader);
    if (obj_field_is(keyword, "deg"))
        return read_degrees(reader);
    if (obj_field_is(keyword, "bmat"))
        return obj_read_matrix(reader);
    if (obj_field_is(keyword, "step"))
        return obj_read_step(reader);
    if (obj_field_is(keyword, "surf"))
        return begin_surface(reader);
    if (obj_field_is(keyword, "parm"))
        return !reader->surface.line || read_knots(reader); /* else of a curve */
    if (obj_field_is(keyword, "end"))
        return end_surface(reader);
    if (obj_field_is(keyword, "trim") || obj_field_is(keyword, "hole"))
        return !reader->surface.line ||
               obj_fail(reader, "a surface with a %.*s: sheen draws whole surfaces only",
                        OBJ_SHOWN(keyword));
    *is_known = is_of_curves(keyword);
    return true;
}
