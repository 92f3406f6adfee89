#include "server/cage/build/piece_basis.h"

/* The share of the coefficient of t^j, j <= k, in Bezier point k of degree n: (k over j) / (n over j)
 * (Farin, Curves and Surfaces for CAGD, chapter 6). */
static double share_of(unsigned n, unsigned k, unsigned j)
{
    double share = 1;
    for (unsigned i = 0; i < j; i++)
        share *= (double)(k - i) / (n - i);
    return share;
}

struct piece_basis piece_basis_cardinal(void)
{
    return (struct piece_basis){
        .degree = 3,
        .step = 1,
        .to_bezier = {{0, 1, 0, 0},
                      {-1 / 6.0, 1, 1 / 6.0, 0},
                      {0, 1 / 6.0, 1, -1 / 6.0},
                      {0, 0, 1, 0}},
    };
}

struct piece_basis piece_basis_taylor(unsigned degree)
{
    struct piece_basis basis = {.degree = degree, .step = degree + 1};
    for (unsigned k = 0; k <= degree; k++)
        for (unsigned j = 0; j <= k; j++)
            basis.to_bezier[k][j] = share_of(degree, k, j);
    return basis;
}

struct piece_basis piece_basis_matrix(unsigned degree, size_t step, const double *matrix)
{
    struct piece_basis basis = {.degree = degree, .step = step};
    for (unsigned k = 0; k <= degree; k++)
        for (unsigned i = 0; i <= degree; i++)
            for (unsigned j = 0; j <= k; j++)
                basis.to_bezier[k][i] += share_of(degree, k, j) * matrix[i * (degree + 1) + j];
    return basis;
}

size_t piece_basis_points(const struct piece_basis *basis, size_t n_pieces)
{
    return (n_pieces - 1) * basis->step + basis->degree + 1;
}

void piece_basis_row(const struct piece_basis *basis, size_t n_pieces, const double (*control)[3],
                     size_t stride, double (*out)[3], size_t out_stride)
{
    for (size_t piece = 0; piece < n_pieces; piece++)
        for (unsigned k = 0; k <= basis->degree; k++, out += out_stride)
            for (int x = 0; x < 3; x++) {
                double sum = 0;
                for (unsigned i = 0; i <= basis->degree; i++)
                    sum += basis->to_bezier[k][i] * control[(piece * basis->step + i) * stride][x];
                (*out)[x] = sum;
            }
}
