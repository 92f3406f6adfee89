#include "server/curves/fields/piece.h"

#include <math.h>
#include <string.h>

enum { MOST_DEGREE = NORMAL_DEGREE };

static const double BINOMIAL[MOST_DEGREE + 1][MOST_DEGREE + 1] = {
    {1}, {1, 1}, {1, 2, 1}, {1, 3, 3, 1}, {1, 4, 6, 4, 1}, {1, 5, 10, 10, 5, 1}};

/* Divides the normal's coefficients by the largest one. */
static void scale_normal(double *n, size_t size)
{
    double most = 0;
    for (size_t k = 0; k < size; k++)
        most = fmax(most, fabs(n[k]));
    if (!(most > 0))
        return;
    double scale = 1 / most;
    for (size_t k = 0; k < size; k++)
        n[k] *= scale;
}

/* The derivatives of a coordinate by u and by v, each coefficient multiplied by its binomial coefficients, so that products are
 * convolutions. */
struct slopes {
    double by_u[3][4], by_v[4][3];
};

static void slopes_of(const double p[4][4], struct slopes *out)
{
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++) {
            if (i < 3)
                out->by_u[i][j] = BINOMIAL[2][i] * BINOMIAL[3][j] * 3 * (p[i + 1][j] - p[i][j]);
            if (j < 3)
                out->by_v[i][j] = BINOMIAL[3][i] * BINOMIAL[2][j] * 3 * (p[i][j + 1] - p[i][j]);
        }
    }
}

/* Adds factor * a_u b_v to the coefficients of the normal. */
static void add_product(const struct slopes *a, const struct slopes *b, double factor,
                        double n[NORMAL_DEGREE + 1][NORMAL_DEGREE + 1])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            for (int k = 0; k < 4; k++)
                for (int l = 0; l < 3; l++)
                    n[i + k][j + l] += factor * a->by_u[i][j] * b->by_v[k][l];
}

void piece_of_bezier(const struct bezier *bezier, struct piece *piece)
{
    struct slopes slopes[3];
    *piece = (struct piece){.size = 1};
    for (int d = 0; d < 3; d++) {
        slopes_of(bezier->p[d], &slopes[d]);
        memcpy(piece->s[d], bezier->p[d], sizeof piece->s[d]);
    }
    for (int d = 0; d < 3; d++) {
        double n[NORMAL_DEGREE + 1][NORMAL_DEGREE + 1] = {{0}};
        const struct slopes *e = &slopes[(d + 1) % 3], *f = &slopes[(d + 2) % 3];
        add_product(e, f, 1, n);
        add_product(f, e, -1, n);
        for (int i = 0; i <= NORMAL_DEGREE; i++)
            for (int j = 0; j <= NORMAL_DEGREE; j++)
                piece->n[d][i * (NORMAL_DEGREE + 1) + j] =
                    n[i][j] / (BINOMIAL[NORMAL_DEGREE][i] * BINOMIAL[NORMAL_DEGREE][j]);
    }
    scale_normal(piece->n[0], sizeof piece->n / sizeof piece->n[0][0]);
}

/* --- halves, by de Casteljau's rule */

/* Halves `n` polynomials of one variable, whose coefficients are `step` apart and which begin `stride` apart. */
static void halve(const double *c, int degree, int step, int n, int stride, double *low,
                  double *high)
{
    double row[MOST_DEGREE + 1];
    for (int o = 0; o < n; o++) {
        for (int i = 0; i <= degree; i++)
            row[i] = c[o * stride + i * step];
        for (int k = 0; k <= degree; k++) {
            low[o * stride + k * step] = row[0];
            high[o * stride + (degree - k) * step] = row[degree - k];
            for (int i = 0; i < degree - k; i++)
                row[i] = 0.5 * (row[i] + row[i + 1]);
        }
    }
}

/* The quarters of a net of equal degrees. */
static void quarter_net(const double *c, int degree, double *const quarters[4])
{
    int width = degree + 1;
    double low[NORMAL_SIZE], high[NORMAL_SIZE];
    halve(c, degree, width, width, 1, low, high);
    halve(low, degree, 1, width, width, quarters[0], quarters[3]);
    halve(high, degree, 1, width, width, quarters[1], quarters[2]);
}

void piece_quarter(const struct piece *piece, struct piece quarters[4])
{
    for (int d = 0; d < 3; d++) {
        double *s[4], *n[4];
        for (int k = 0; k < 4; k++) {
            s[k] = quarters[k].s[d];
            n[k] = quarters[k].n[d];
        }
        quarter_net(piece->s[d], POSITION_DEGREE, s);
        quarter_net(piece->n[d], NORMAL_DEGREE, n);
    }
    for (int k = 0; k < 4; k++) {
        struct piece *quarter = &quarters[k];
        quarter->size = 0.5 * piece->size;
        quarter->at[0] = piece->at[0] + (k == 1 || k == 2 ? quarter->size : 0);
        quarter->at[1] = piece->at[1] + (k >= 2 ? quarter->size : 0);
        scale_normal(quarter->n[0], sizeof quarter->n / sizeof quarter->n[0][0]);
    }
}

double piece_reach(const struct piece *piece)
{
    double reach = 0;
    for (int d = 0; d < 3; d++)
        for (int k = 0; k < POSITION_SIZE; k++)
            reach = fmax(reach, fabs(piece->s[d][k]));
    return reach;
}

/* --- segments */

/* Copies a side of a net. */
static void side_of(const double *net, int degree, int side, double *out)
{
    static const int at_u[4] = {0, 1, 1, 0}, at_v[4] = {0, 0, 1, 1};
    static const int by_u[4] = {1, 0, -1, 0}, by_v[4] = {0, 1, 0, -1};
    int width = degree + 1;
    const double *from = net + degree * (at_u[side] * width + at_v[side]);
    for (int k = 0; k <= degree; k++)
        out[k] = from[k * (by_u[side] * width + by_v[side])];
}

void piece_side(const struct piece *piece, int side, struct segment *segment)
{
    const double u[5] = {0, 1, 1, 0, 0}, v[5] = {0, 0, 1, 1, 0};
    segment->from[0] = piece->at[0] + piece->size * u[side];
    segment->from[1] = piece->at[1] + piece->size * v[side];
    segment->to[0] = piece->at[0] + piece->size * u[side + 1];
    segment->to[1] = piece->at[1] + piece->size * v[side + 1];
    for (int d = 0; d < 3; d++) {
        side_of(piece->s[d], POSITION_DEGREE, side, segment->s[d]);
        side_of(piece->n[d], NORMAL_DEGREE, side, segment->n[d]);
    }
    scale_normal(segment->n[0], sizeof segment->n / sizeof segment->n[0][0]);
}

/* Adds factor * a b, of degrees 2 and 3, to the coefficients of the normal, which are multiplied by their binomial coefficients. */
static void add_curves(const double a[3], const double b[4], double factor,
                       double n[NORMAL_DEGREE + 1])
{
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 4; k++)
            n[i + k] += factor * BINOMIAL[2][i] * BINOMIAL[3][k] * a[i] * b[k];
}

void segment_of_bezier(const struct bezier *bezier, int side, struct segment *segment)
{
    /* The first point of each side, and the steps along it. */
    static const int first[4][2] = {{0, 0}, {3, 0}, {3, 3}, {0, 3}};
    static const int step[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    int along_u = step[side][0], along_v = step[side][1];
    double along[3][3], inward[3][4];
    for (int d = 0; d < 3; d++) {
        for (int k = 0; k < 4; k++) {
            int i = first[side][0] + k * along_u, j = first[side][1] + k * along_v;
            segment->s[d][k] = bezier->p[d][i][j];
            inward[d][k] = bezier->p[d][i - along_v][j + along_u] - bezier->p[d][i][j];
        }
        for (int k = 0; k < 3; k++)
            along[d][k] = segment->s[d][k + 1] - segment->s[d][k];
    }
    for (int k = 0; k < 2; k++) {
        segment->from[k] = first[side][k] ? 1 : 0;
        segment->to[k] = first[(side + 1) & 3][k] ? 1 : 0;
    }
    for (int d = 0; d < 3; d++) {
        double n[NORMAL_DEGREE + 1] = {0};
        int e = (d + 1) % 3, f = (d + 2) % 3;
        add_curves(along[e], inward[f], 1, n);
        add_curves(along[f], inward[e], -1, n);
        for (int k = 0; k <= NORMAL_DEGREE; k++)
            segment->n[d][k] = n[k] / BINOMIAL[NORMAL_DEGREE][k];
    }
    scale_normal(segment->n[0], sizeof segment->n / sizeof segment->n[0][0]);
}

static void swap(double *a, double *b)
{
    double kept = *a;
    *a = *b;
    *b = kept;
}

void segment_reverse(struct segment *segment)
{
    for (int d = 0; d < 3; d++) {
        for (int k = 0; 2 * k < POSITION_DEGREE; k++)
            swap(&segment->s[d][k], &segment->s[d][POSITION_DEGREE - k]);
        for (int k = 0; 2 * k < NORMAL_DEGREE; k++)
            swap(&segment->n[d][k], &segment->n[d][NORMAL_DEGREE - k]);
    }
    for (int k = 0; k < 2; k++)
        swap(&segment->from[k], &segment->to[k]);
}

void segment_halve(const struct segment *segment, struct segment half[2])
{
    for (int d = 0; d < 3; d++) {
        halve(segment->s[d], POSITION_DEGREE, 1, 1, 0, half[0].s[d], half[1].s[d]);
        halve(segment->n[d], NORMAL_DEGREE, 1, 1, 0, half[0].n[d], half[1].n[d]);
    }
    for (int k = 0; k < 2; k++) {
        double middle = 0.5 * (segment->from[k] + segment->to[k]);
        half[0].from[k] = segment->from[k];
        half[0].to[k] = half[1].from[k] = middle;
        half[1].to[k] = segment->to[k];
    }
    for (int k = 0; k < 2; k++)
        scale_normal(half[k].n[0], sizeof half[k].n / sizeof half[k].n[0][0]);
}

/* --- ranges */

/* The Taylor coefficients of the Bernstein polynomials in the middle of [-1, 1]: row k is the factor of x^k. */
static const double CUBIC[4][MOST_DEGREE + 1] = {{1 / 8., 3 / 8., 3 / 8., 1 / 8.},
                                                 {-3 / 8., -3 / 8., 3 / 8., 3 / 8.},
                                                 {3 / 8., -3 / 8., -3 / 8., 3 / 8.},
                                                 {-1 / 8., 3 / 8., -3 / 8., 1 / 8.}};
static const double QUINTIC[6][MOST_DEGREE + 1] = {
    {1 / 32., 5 / 32., 10 / 32., 10 / 32., 5 / 32., 1 / 32.},
    {-5 / 32., -15 / 32., -10 / 32., 10 / 32., 15 / 32., 5 / 32.},
    {10 / 32., 10 / 32., -20 / 32., -20 / 32., 10 / 32., 10 / 32.},
    {-10 / 32., 10 / 32., 20 / 32., -20 / 32., -10 / 32., 10 / 32.},
    {5 / 32., -15 / 32., 10 / 32., 10 / 32., -15 / 32., 5 / 32.},
    {-1 / 32., 5 / 32., -10 / 32., 10 / 32., -5 / 32., 1 / 32.}};

static const double (*weights_of(int degree))[MOST_DEGREE + 1]
{
    return degree == POSITION_DEGREE ? CUBIC : QUINTIC;
}

static double dot(const double *a, const double *b, int degree)
{
    double sum = 0;
    for (int k = 0; k <= degree; k++)
        sum += a[k] * b[k];
    return sum;
}

/* A range from all Taylor coefficients of a polynomial, t[i][j] of x^i y^j, with degrees m and n. */
static void range_of(double t[MOST_DEGREE + 1][MOST_DEGREE + 1], int m, int n,
                     double out[RANGE_SIZE])
{
    memset(out, 0, RANGE_SIZE * sizeof *out);
    for (int i = 0; i <= m; i++) {
        for (int j = 0; j <= n; j++) {
            double size = fabs(t[i][j]);
            if (i + j <= RANGE_ORDER) {
                out[range_at(i, j)] = t[i][j];
                continue;
            }
            out[RANGE_REST] += size;
            out[RANGE_REST + 1] += i * size;
            out[RANGE_REST + 2] += j * size;
        }
    }
    range_complete(out);
}

static void net_range(const double *c, int degree, double out[RANGE_SIZE])
{
    const double(*w)[MOST_DEGREE + 1] = weights_of(degree);
    double by_v[MOST_DEGREE + 1][MOST_DEGREE + 1]; /* order along v, row */
    double t[MOST_DEGREE + 1][MOST_DEGREE + 1];
    for (int i = 0; i <= degree; i++)
        for (int j = 0; j <= degree; j++)
            by_v[j][i] = dot(c + i * (degree + 1), w[j], degree);
    for (int i = 0; i <= degree; i++)
        for (int j = 0; j <= degree; j++)
            t[i][j] = dot(by_v[j], w[i], degree);
    range_of(t, degree, degree, out);
}

static void curve_range(const double *c, int degree, double out[RANGE_SIZE])
{
    const double(*w)[MOST_DEGREE + 1] = weights_of(degree);
    double t[MOST_DEGREE + 1][MOST_DEGREE + 1];
    for (int i = 0; i <= degree; i++)
        t[i][0] = dot(c, w[i], degree);
    range_of(t, degree, 0, out);
}

/* The normal's coordinate in the middle. */
static double net_middle(const double *c)
{
    double value[NORMAL_DEGREE + 1];
    for (int i = 0; i <= NORMAL_DEGREE; i++)
        value[i] = dot(c + i * (NORMAL_DEGREE + 1), QUINTIC[0], NORMAL_DEGREE);
    return dot(value, QUINTIC[0], NORMAL_DEGREE);
}

/* The axes for the normal's coefficients: across the normal in the middle, and along it. */
static void axes_of(const double middle[3], double axes[3][3])
{
    const struct vec n = vec_unit((struct vec){middle[0], middle[1], middle[2]});
    bool is_steep = fabs(n.x) > 0.7;
    const struct vec a = vec_unit(vec_cross(n, (struct vec){!is_steep, is_steep, 0}));
    const struct vec b = vec_cross(n, a), all[3] = {a, b, n};
    for (int i = 0; i < 3; i++) {
        axes[i][0] = all[i].x;
        axes[i][1] = all[i].y;
        axes[i][2] = all[i].z;
    }
}

/* The coefficients along an axis. */
static void turn(const double *n, size_t size, const double axis[3], double *out)
{
    for (size_t k = 0; k < size; k++)
        out[k] = axis[0] * n[k] + axis[1] * n[size + k] + axis[2] * n[2 * size + k];
}

/* The normal from its ranges along the axes. */
static void direction_of(const double along[3][RANGE_SIZE], const double axes[3][3],
                         double out[3][RANGE_SIZE])
{
    double a[RANGE_SIZE], b[RANGE_SIZE];
    range_quotient(along[0], along[2], a);
    range_quotient(along[1], along[2], b);
    double one[RANGE_SIZE] = {1};
    for (int d = 0; d < 3; d++) {
        const double factor[3] = {axes[0][d], axes[1][d], axes[2][d]};
        const double *const all[3] = {a, b, one};
        range_combine(factor, all, out[d]);
    }
}

void piece_find_range(const struct piece *piece, struct piece_range *range)
{
    double middle[3], axes[3][3], turned[NORMAL_SIZE], along[3][RANGE_SIZE];
    for (int d = 0; d < 3; d++) {
        net_range(piece->s[d], POSITION_DEGREE, range->s[d]);
        middle[d] = net_middle(piece->n[d]);
    }
    axes_of(middle, axes);
    for (int i = 0; i < 3; i++) {
        turn(piece->n[0], NORMAL_SIZE, axes[i], turned);
        net_range(turned, NORMAL_DEGREE, along[i]);
    }
    direction_of(along, axes, range->n);
}

void segment_find_range(const struct segment *segment, struct piece_range *range)
{
    double middle[3], axes[3][3], turned[NORMAL_DEGREE + 1], along[3][RANGE_SIZE];
    for (int d = 0; d < 3; d++) {
        curve_range(segment->s[d], POSITION_DEGREE, range->s[d]);
        middle[d] = dot(segment->n[d], QUINTIC[0], NORMAL_DEGREE);
    }
    axes_of(middle, axes);
    for (int i = 0; i < 3; i++) {
        turn(segment->n[0], NORMAL_DEGREE + 1, axes[i], turned);
        curve_range(turned, NORMAL_DEGREE, along[i]);
    }
    direction_of(along, axes, range->n);
}
