#include "server/curves/compare/align.h"

#include <math.h>
#include <stdlib.h>

/* A motion of unit size (of the model's size, or 1 rad about its middle) that moves the points along their normals by less
 * than the root of this, as a mean square, slides the surface along itself. */
static const double LEAST_HOLD = 1e-6;

bool alignment_init(struct alignment *alignment, double size, struct error *error)
{
    *alignment = (struct alignment){.size = size, .rms_before = -1};
    for (int k = 0; k < 3; k++)
        alignment->motion.row[k] = (struct vec){k == 0, k == 1, k == 2};
    alignment->pairs = calloc(ALIGN_PAIRS, sizeof *alignment->pairs);
    alignment->distances = calloc(ALIGN_PAIRS, sizeof *alignment->distances);
    return (alignment->pairs && alignment->distances) ||
           error_set(error, ERROR_SERVER, "no memory to align two surfaces");
}

void alignment_finish(struct alignment *alignment)
{
    free(alignment->pairs);
    free(alignment->distances);
    *alignment = (struct alignment){0};
}

/* A low-discrepancy sequence (Roberts): term i in [0,1). */
static double spread(size_t i, double step)
{
    double x = 0.5 + (double)(i + 1) * step;
    return x - floor(x);
}

void alignment_pair(struct alignment *alignment, const struct kept_surface *moved,
                    const struct surface_tree *fixed, const struct closest_rules *rules,
                    size_t slice)
{
    struct closest_rules far = *rules;
    far.reach = 0.05 * alignment->size;
    for (size_t k = 0; k < ALIGN_PAIRS_OF_SLICE; k++) {
        size_t i = slice * ALIGN_PAIRS_OF_SLICE + k;
        struct align_pair *pair = &alignment->pairs[i];
        struct limit_point at;
        struct closest to;
        const struct closest_start nowhere = {.leaf = SIZE_MAX};
        pair->is_known = false;
        kept_surface_evaluate(moved, i * moved->n_leaves / ALIGN_PAIRS,
                              spread(i, 0.7548776662466927), spread(i, 0.5698402909980532), &at);
        if (!at.has_normal)
            continue;
        closest_find(fixed, &far, at.s, at.n, &nowhere, &to);
        if (to.kind == CLOSEST_NONE || to.kind == CLOSEST_BORDER || !to.at.has_normal)
            continue;
        double distance = vec_dot(to.at.n, vec_sub(to.at.s, at.s));
        *pair = (struct align_pair){at.s, to.at.n, distance, true};
    }
}

static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The distance that nine tenths of the pairs do not exceed; a negative number without pairs. */
static double largest_used(struct alignment *alignment)
{
    size_t n = 0;
    for (size_t i = 0; i < ALIGN_PAIRS; i++)
        if (alignment->pairs[i].is_known)
            alignment->distances[n++] = fabs(alignment->pairs[i].distance);
    qsort(alignment->distances, n, sizeof *alignment->distances, by_size);
    return n ? alignment->distances[n - 1 - n / 10] : -1;
}

/* Solves a x = b for a symmetric positive definite matrix by Cholesky's decomposition; b becomes x. False if the matrix
 * is not positive definite. */
static bool solve(double a[6][6], double b[6])
{
    for (int j = 0; j < 6; j++) {
        for (int k = 0; k < j; k++)
            a[j][j] -= a[j][k] * a[j][k];
        if (!(a[j][j] > 0))
            return false;
        a[j][j] = sqrt(a[j][j]);
        for (int i = j + 1; i < 6; i++) {
            for (int k = 0; k < j; k++)
                a[i][j] -= a[i][k] * a[j][k];
            a[i][j] /= a[j][j];
        }
    }
    for (int i = 0; i < 6; i++) {
        for (int k = 0; k < i; k++)
            b[i] -= a[i][k] * b[k];
        b[i] /= a[i][i];
    }
    for (int i = 6; i-- > 0;) {
        for (int k = i + 1; k < 6; k++)
            b[i] -= a[k][i] * b[k];
        b[i] /= a[i][i];
    }
    return true;
}

/* One rotation of Jacobi's method, which makes a[p][q] zero. */
static void rotate(double a[6][6], int p, int q)
{
    double half = 0.5 * (a[q][q] - a[p][p]) / a[p][q];
    double t = (half < 0 ? -1 : 1) / (fabs(half) + sqrt(half * half + 1));
    double c = 1 / sqrt(t * t + 1), s = t * c;
    for (int k = 0; k < 6; k++) {
        double x = a[k][p], y = a[k][q];
        a[k][p] = c * x - s * y;
        a[k][q] = s * x + c * y;
    }
    for (int k = 0; k < 6; k++) {
        double x = a[p][k], y = a[q][k];
        a[p][k] = c * x - s * y;
        a[q][k] = s * x + c * y;
    }
}

/* The number of eigenvalues below a limit, of a symmetric matrix whose lower triangle is given: Jacobi's method. */
static unsigned count_below(const double lower[6][6], double limit)
{
    double a[6][6];
    for (int i = 0; i < 6; i++)
        for (int k = 0; k < 6; k++)
            a[i][k] = i >= k ? lower[i][k] : lower[k][i];
    for (int sweep = 0; sweep < 12; sweep++)
        for (int p = 0; p < 5; p++)
            for (int q = p + 1; q < 6; q++)
                if (fabs(a[p][q]) > 1e-3 * limit)
                    rotate(a, p, q);
    unsigned n = 0;
    for (int k = 0; k < 6; k++)
        n += a[k][k] < limit;
    return n;
}

/* The rotation by the vector w (its length is the angle) by Rodrigues' formula. */
static struct rigid_motion rotation_by(struct vec w)
{
    double angle = vec_length(w);
    double s = angle > 0 ? sin(angle) / angle : 1;
    double c = angle > 0 ? (1 - cos(angle)) / (angle * angle) : 0.5;
    struct rigid_motion out = {.shift = {0, 0, 0}};
    const struct vec unit[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int k = 0; k < 3; k++) { /* the rows are the columns of the inverse rotation */
        struct vec turned = vec_cross(unit[k], w);
        out.row[k] = vec_mad(vec_mad(unit[k], s, turned), c, vec_cross(turned, w));
    }
    return out;
}

/* The motion `first`, and then the rotation about `centre` and the shift. */
static struct rigid_motion then(const struct rigid_motion *first, struct vec w, struct vec centre,
                                struct vec shift)
{
    struct rigid_motion turn = rotation_by(w), out;
    for (int k = 0; k < 3; k++) {
        const double of[3] = {turn.row[k].x, turn.row[k].y, turn.row[k].z};
        out.row[k] = vec_scale(first->row[0], of[0]);
        out.row[k] = vec_mad(vec_mad(out.row[k], of[1], first->row[1]), of[2], first->row[2]);
    }
    struct vec about = motion_turn(&turn, vec_sub(first->shift, centre));
    out.shift = vec_add(vec_add(about, centre), shift);
    return out;
}

/* Adds a pair to the normal equations of (rotation vector, shift / size). */
static void add_pair(const struct align_pair *pair, struct vec centre, double size, double a[6][6],
                     double b[6])
{
    struct vec arm = vec_scale(vec_sub(pair->p, centre), 1 / size);
    struct vec turn = vec_cross(arm, pair->n);
    const double row[6] = {turn.x, turn.y, turn.z, pair->n.x, pair->n.y, pair->n.z};
    for (int i = 0; i < 6; i++) {
        for (int k = 0; k <= i; k++)
            a[i][k] += row[i] * row[k];
        b[i] += row[i] * pair->distance / size;
    }
}

void alignment_solve(struct alignment *alignment)
{
    double most = largest_used(alignment), a[6][6] = {{0}}, b[6] = {0}, square = 0, n = 0;
    struct vec centre = {0, 0, 0};
    for (size_t i = 0; i < ALIGN_PAIRS; i++) {
        const struct align_pair *pair = &alignment->pairs[i];
        if (!pair->is_known || fabs(pair->distance) > most)
            continue;
        centre = vec_add(centre, pair->p);
        square += pair->distance * pair->distance;
        n++;
    }
    if (n == 0) {
        alignment->is_done = true;
        return;
    }
    centre = vec_scale(centre, 1 / n);
    alignment->rms_after = sqrt(square / n);
    if (alignment->rms_before < 0)
        alignment->rms_before = alignment->rms_after;
    for (size_t i = 0; i < ALIGN_PAIRS; i++) {
        const struct align_pair *pair = &alignment->pairs[i];
        if (pair->is_known && fabs(pair->distance) <= most)
            add_pair(pair, centre, alignment->size, a, b);
    }
    alignment->free_directions = count_below(a, LEAST_HOLD * n);
    /* Where the surface slides along itself, the matrix is singular: this share keeps such motions at 0. */
    for (int k = 0; k < 6; k++)
        a[k][k] += 1e-9 * n;
    if (!solve(a, b)) {
        alignment->is_done = true;
        return;
    }
    struct vec w = {b[0], b[1], b[2]},
               shift = vec_scale((struct vec){b[3], b[4], b[5]}, alignment->size);
    alignment->motion = then(&alignment->motion, w, centre, shift);
    alignment->is_done = vec_length(w) < 1e-10 && vec_length(shift) < 1e-10 * alignment->size;
}

double motion_angle_deg(const struct rigid_motion *motion)
{
    const struct vec *row = motion->row;
    struct vec twice = {row[2].y - row[1].z, row[0].z - row[2].x, row[1].x - row[0].y};
    double cosine = 0.5 * (row[0].x + row[1].y + row[2].z - 1);
    return atan2(0.5 * vec_length(twice), cosine) * (180 / M_PI);
}
