/* Curves and surfaces that are given piece by piece in any polynomial basis of degree 1 to 3:
 * cardinal, Taylor, or by a matrix (Wavefront, OBJ file format 3.0). Piece k uses the degree + 1
 * control points from k step on. Converted to Bezier points in double. Pure, any thread. Internal
 * to server/cage. */
#ifndef SHEEN_CAGE_BUILD_PIECE_BASIS_H
#define SHEEN_CAGE_BUILD_PIECE_BASIS_H

#include <stddef.h>

struct piece_basis {
    unsigned degree; /* 1 to 3 */
    size_t step;     /* control points from one piece to the next, from 1 */
    /* A piece's Bezier point k is the sum over i of to_bezier[k][i] times its control point i. */
    double to_bezier[4][4];
};

/* Cardinal cubics: a piece goes from its second control point to its third, with half of the
 * distance of the neighbours of each as the derivative there (Catmull and Rom, A class of local
 * interpolating splines, 1974). */
struct piece_basis piece_basis_cardinal(void);
/* Control point i is the coefficient of t^i, t from 0 to 1 along the piece. */
struct piece_basis piece_basis_taylor(unsigned degree);
/* Control point i has the weight sum over j of matrix[i (degree + 1) + j] t^j, t from 0 to 1 along
 * the piece. */
struct piece_basis piece_basis_matrix(unsigned degree, size_t step, const double *matrix);

/* The control points that n_pieces, at least 1, use. */
size_t piece_basis_points(const struct piece_basis *basis, size_t n_pieces);

/* Gets all pieces' Bezier points, degree + 1 for each, of a row of control points: control[0],
 * control[stride] and so on, and likewise out. */
void piece_basis_row(const struct piece_basis *basis, size_t n_pieces, const double (*control)[3],
                     size_t stride, double (*out)[3], size_t out_stride);

#endif
