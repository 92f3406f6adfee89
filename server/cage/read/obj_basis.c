/* Bases of free-form surfaces of OBJ beside bezier and bspline, and weights of their points. */
#include <math.h>

#include "server/cage/read/numbers/decimal.h"
#include "server/cage/read/obj_reader.h"

/* The largest step that is read; with it a number of control points is far below SIZE_MAX. */
#define MAX_STEP 1e6

bool obj_read_matrix(struct obj_reader *reader)
{
    struct obj_field field;
    if (!obj_text_field(&reader->text, &field) ||
        (!obj_field_is(&field, "u") && !obj_field_is(&field, "v")))
        return obj_fail(reader, "bmat needs u or v");
    struct obj_numbers *matrix = &reader->surface.matrix[obj_field_is(&field, "v")];
    matrix->n = 0;
    return obj_read_numbers(reader, "a number of bmat", matrix);
}

bool obj_read_step(struct obj_reader *reader)
{
    struct obj_field field;
    reader->surface.step[0] = reader->surface.step[1] = 0;
    for (int a = 0; a < 2 && obj_text_field(&reader->text, &field); a++)
        if (!obj_read_number(reader, &field, "a step", &reader->surface.step[a]))
            return false;
    return true;
}

bool obj_has_piece_basis(const struct obj_surface *surface)
{
    return obj_field_is(&surface->type, "cardinal") || obj_field_is(&surface->type, "taylor") ||
           obj_field_is(&surface->type, "bmatrix");
}

static bool basis_of_matrix(const struct obj_reader *reader, int axis, struct piece_basis *basis)
{
    const struct obj_surface *surface = &reader->surface;
    const struct obj_numbers *matrix = &surface->matrix[axis];
    const unsigned degree = (unsigned)surface->degree[axis];
    const double step = surface->step[axis];
    if (matrix->n != ((size_t)degree + 1) * (degree + 1))
        return obj_fail(reader, "bmat %c has %zu numbers, degree %u needs %u", "uv"[axis],
                        matrix -> n, degree, (degree + 1) * (degree + 1));
    if (!(step >= 1 && step <= MAX_STEP && step == floor(step)))
        return obj_fail(reader, "the step along %c is %.9g, not a whole number from 1 to %.0f",
                        "uv"[axis], step, MAX_STEP);
    *basis = piece_basis_matrix(degree, (size_t)step, matrix->value);
    return true;
}

bool obj_piece_basis(const struct obj_reader *reader, int axis, struct piece_basis *basis)
{
    const struct obj_surface *surface = &reader->surface;
    const struct obj_numbers *breaks = &surface->knots[axis];
    const unsigned degree = (unsigned)surface->degree[axis];
    if (obj_field_is(&surface->type, "bmatrix"))
        return basis_of_matrix(reader, axis, basis);
    if (obj_field_is(&surface->type, "cardinal")) {
        *basis = piece_basis_cardinal();
        return degree == basis->degree ||
               obj_fail(reader, "a cardinal surface of degree %u along %c: the degree is 3", degree,
                        "uv"[axis]);
    }
    *basis = piece_basis_taylor(degree);
    /* Programs disagree about whether t is the parameter or the place within the piece. */
    return (breaks->n == 2 && breaks->value[0] == 0 && breaks->value[1] == 1) ||
           obj_fail(reader, "parm %c of a taylor surface: sheen draws one piece from 0 to 1",
                    "uv"[axis]);
}

bool obj_read_weight(struct obj_reader *reader)
{
    const size_t vertex = reader->builder->cage.n_vertices;
    struct obj_field field, more;
    double weight = 1;
    if (obj_text_field(&reader->text, &field) && !obj_text_field(&reader->text, &more) &&
        decimal_read(field.text, field.length, reader->c_locale, &weight) != DECIMAL_OK)
        weight = NAN;
    if (weight == 1 && reader->weight.n == 0)
        return true;
    while (reader->weight.n < vertex)
        if (!obj_add_number(reader, &reader->weight, 1))
            return false;
    return obj_add_number(reader, &reader->weight, weight);
}

double obj_weight_of(const struct obj_reader *reader, uint32_t vertex)
{
    return vertex < reader->weight.n ? reader->weight.value[vertex] : 1;
}
