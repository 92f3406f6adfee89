#include "server/curves/compare/closest.h"

#include <float.h>
#include <math.h>

/* Places beyond a piece by this share of its sides belong to it: pieces meet within rounding only. */
static const double BESIDE = 1e-6;
/* Newton's method has come to the end when a step is below this share of a piece: its error is then the square. */
static const double SMALL_STEP = 1e-7;
enum { MOST_STEPS = 12, MOST_NEAR_STEPS = 30 };

/* A rectangle of a leaf. */
struct rectangle {
    size_t leaf;
    double x, y, width, height;
};

static struct rectangle rectangle_of(const struct tree_piece *piece)
{
    return (struct rectangle){piece->leaf, (double)piece->x, (double)piece->y, (double)piece->width,
                              (double)piece->height};
}

static bool is_within(const struct rectangle *r, double x, double y)
{
    return x >= r->x - BESIDE * r->width && x <= r->x + (1 + BESIDE) * r->width &&
           y >= r->y - BESIDE * r->height && y <= r->y + (1 + BESIDE) * r->height;
}

static double within(double x, double least, double most)
{
    return fmin(fmax(x, least), most);
}

struct search {
    const struct surface_tree *tree;
    const struct closest_rules *rules;
    struct vec p, n;
    struct vec across[2]; /* unit, perpendicular to n and to each other */
    double inverse[3];    /* of n's coordinates */
    bool
        is_across[3]; /* a coordinate is so small that the line does not change it within a model */
    double reach;     /* nothing farther along n is of interest any more */
    double agreement; /* cosine between n and the normal at `best` */
    struct made_levels *made;
    struct closest *best;
};

/* A place where the line meets the surface is a counterpart unless it is the other side of a body. */
static void take_met(struct search *search, size_t leaf, double x, double y,
                     const struct limit_point *at)
{
    double distance = vec_dot(search->n, vec_sub(at->s, search->p)), away = fabs(distance);
    double cosine = at->has_normal ? search->rules->winding * vec_dot(search->n, at->n) : 0;
    if (!(away <= search->reach) || (cosine < 0 && away > search->rules->coincident))
        return;
    if (search->best->kind == CLOSEST_RAY) {
        double nearest = fabs(search->best->distance), slack = search->rules->tolerance;
        if (away >= nearest - slack && cosine <= search->agreement)
            return;
    }
    search->reach = fmin(search->reach, away + search->rules->tolerance);
    search->agreement = cosine;
    *search->best = (struct closest){CLOSEST_RAY, leaf, x, y, *at, distance};
}

/* Newton's method for the place of a rectangle on the line, from (x,y). Nothing if it leaves the rectangle by more than
 * its size. */
static void meet(struct search *search, const struct rectangle *in, double x, double y)
{
    const struct kept_surface *surface = search->tree->surface;
    bool is_last = false;
    for (int step = 0; step < MOST_STEPS; step++) {
        struct limit_point at;
        kept_surface_evaluate_again(surface, in->leaf, x, y, search->made, &at);
        struct vec d = vec_sub(at.s, search->p);
        double f = vec_dot(search->across[0], d), g = vec_dot(search->across[1], d);
        if (is_last || (f == 0 && g == 0)) {
            if (is_within(in, x, y))
                take_met(search, in->leaf, within(x, 0, 1), within(y, 0, 1), &at);
            return;
        }
        double fx = vec_dot(search->across[0], at.su), fy = vec_dot(search->across[0], at.sv);
        double gx = vec_dot(search->across[1], at.su), gy = vec_dot(search->across[1], at.sv);
        double det = fx * gy - fy * gx;
        double dx = (fy * g - gy * f) / det, dy = (gx * f - fx * g) / det;
        if (!(fabs(dx) < 4 * in->width && fabs(dy) < 4 * in->height))
            return; /* parallel to the line, or far away */
        x += dx;
        y += dy;
        if (!(fabs(x - in->x - 0.5 * in->width) <= 1.5 * in->width &&
              fabs(y - in->y - 0.5 * in->height) <= 1.5 * in->height))
            return;
        is_last = fabs(dx) < SMALL_STEP * in->width && fabs(dy) < SMALL_STEP * in->height;
    }
}

/* As fmin() and fmax(), which are calls. */
static inline double smaller(double a, double b)
{
    return a < b ? a : b;
}

static inline double larger(double a, double b)
{
    return a > b ? a : b;
}

/* Narrows the range of distances along the line to where it may be in a box. False if it misses the box. */
static bool clip(const struct search *search, const struct tree_box *box, double range[2])
{
    const double p[3] = {search->p.x, search->p.y, search->p.z};
    double least = range[0], most = range[1];
    for (int k = 0; k < 3; k++) {
        double low = (double)box->least[k], high = (double)box->most[k];
        double margin = 1e-6 * (high - low);
        low -= margin + p[k];
        high += margin - p[k];
        if (search->is_across[k]) {
            if (low > 0 || high < 0)
                return false;
            continue;
        }
        double a = low * search->inverse[k], b = high * search->inverse[k];
        least = larger(least, smaller(a, b));
        most = smaller(most, larger(a, b));
    }
    range[0] = least;
    range[1] = most;
    return least <= most;
}

/* The least |distance| at which the line may be in a box, or infinity. */
static double enter(const struct search *search, const struct tree_box *box)
{
    double range[2] = {-search->reach, search->reach};
    if (!clip(search, box, range))
        return INFINITY;
    return range[0] > 0 ? range[0] : range[1] < 0 ? -range[1] : 0;
}

static const struct corner_sector *sector_of(const struct surface_tree *tree, size_t leaf)
{
    return &tree->sectors[tree->surface->leaves[leaf].corner];
}

static void meet_rest(struct search *search, const struct rectangle *in)
{
    const struct kept_surface *surface = search->tree->surface;
    const struct corner_sector *sector = sector_of(search->tree, in->leaf);
    struct vec d = vec_sub(search->p, sector->vertex.s);
    double away = hypot(vec_dot(search->across[0], d), vec_dot(search->across[1], d)), starts[3][2];
    if (away <= 1e-8 * sector->extent) {
        take_met(search, in->leaf, 0, 0, &sector->vertex);
        return;
    }
    double side = fmin(
        2 * corner_rest_starts(sector, surface, in->leaf, away, search->made, starts), in->width);
    const struct rectangle level = {in->leaf, 0, 0, side, side};
    for (int k = 0; k < 3; k++)
        meet(search, &level, starts[k][0], starts[k][1]);
}

static void meet_pieces(struct search *search, size_t first, size_t end)
{
    for (size_t i = first; i < end; i++) {
        const struct tree_piece *piece = &search->tree->pieces[i];
        const struct closest *best = search->best;
        struct rectangle in = rectangle_of(piece);
        bool is_found =
            best->kind == CLOSEST_RAY && best->leaf == in.leaf && is_within(&in, best->x, best->y);
        double range[2] = {-search->reach, search->reach};
        if (is_found || !clip(search, &piece->box, range))
            continue;
        if (piece->is_corner &&
            !corner_sector_clip(sector_of(search->tree, in.leaf), search->p, search->n, range))
            continue;
        if (piece->is_rest)
            meet_rest(search, &in);
        else
            meet(search, &in, in.x + 0.5 * in.width, in.y + 0.5 * in.height);
    }
}

struct visit {
    unsigned depth;
    size_t j;
    double distance;
};
enum { MOST_DEPTH = 64 };

static const struct tree_box *box_of(const struct surface_tree *tree, unsigned d, size_t j)
{
    return &tree->boxes[((size_t)1 << d) - 1 + j];
}

static bool is_cancelled(const struct surface_tree *tree)
{
    return tree->computation && computation_is_cancelled(tree->computation);
}

static void meet_tree(struct search *search)
{
    const struct surface_tree *tree = search->tree;
    struct visit stack[MOST_DEPTH];
    int n = 0;
    stack[n++] = (struct visit){0, 0, enter(search, box_of(tree, 0, 0))};
    while (n > 0) {
        struct visit at = stack[--n];
        if (!(at.distance <= search->reach))
            continue;
        if (at.depth == tree->depth) {
            if (is_cancelled(tree))
                return;
            meet_pieces(search, tree_first(tree, at.depth, at.j),
                        tree_first(tree, at.depth, at.j + 1));
            continue;
        }
        struct visit next[2];
        for (int k = 0; k < 2; k++) {
            size_t j = 2 * at.j + (size_t)k;
            next[k] = (struct visit){at.depth + 1, j, enter(search, box_of(tree, at.depth + 1, j))};
        }
        int nearer = next[1].distance < next[0].distance;
        stack[n++] = next[!nearer];
        stack[n++] = next[nearer];
    }
}

/* --- the nearest point --------------------------------------------------------------------------- */

/* How well a place's normal agrees with the point's, and the nearest place for each. */
enum agreement { AGREES, SAME_SIDE, ANY_SIDE, AGREEMENTS };

struct near_search {
    const struct surface_tree *tree;
    const struct closest_rules *rules; /* NULL: any side */
    struct vec p, n;
    struct closest best[AGREEMENTS]; /* distance: never negative */
    double border;                   /* the least distance of a place where the surface ends */
    struct made_levels *made;
};

static double distance_to_box(struct vec p, const struct tree_box *box)
{
    const double at[3] = {p.x, p.y, p.z};
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        double d = larger(larger((double)box->least[k] - at[k], at[k] - (double)box->most[k]), 0);
        sum += d * d;
    }
    return sqrt(sum);
}

/* Places farther than this are of no interest. */
static double near_limit(const struct near_search *search)
{
    if (!search->rules)
        return search->best[ANY_SIDE].distance;
    return search->best[SAME_SIDE].distance + search->rules->tolerance;
}

/* Nor are places farther than this, unless the surface ends there: none of the nearest places would change. */
static double useful_limit(const struct near_search *search)
{
    double limit = near_limit(search), agrees = search->best[AGREES].distance;
    return agrees < limit ? agrees : limit;
}

static void take_near(struct near_search *search, size_t leaf, double x, double y,
                      const struct limit_point *at)
{
    double distance = vec_length(vec_sub(at->s, search->p));
    if (!(distance < near_limit(search)))
        return;
    if (search->rules && distance < search->border &&
        kept_surface_at_border(search->tree->surface, leaf, x, y))
        search->border = distance;
    double cosine =
        search->rules && at->has_normal ? search->rules->winding * vec_dot(search->n, at->n) : 1;
    for (int k = cosine >= 0.5 ? AGREES : cosine >= 0 ? SAME_SIDE : ANY_SIDE; k < AGREEMENTS; k++)
        if (distance < search->best[k].distance)
            search->best[k] = (struct closest){CLOSEST_NEAR, leaf, x, y, *at, distance};
}

/* One coordinate of a step of Newton's method stops at the border of its range when it would leave it. */
static bool is_held(double x, double least, double most, double downhill)
{
    return (x <= least && downhill < 0) || (x >= most && downhill > 0);
}

/* Minimises the distance within a rectangle, from (x,y). True if the minimum lies inside of it. */
static bool approach(struct near_search *search, const struct rectangle *in, double x, double y)
{
    const struct kept_surface *surface = search->tree->surface;
    double x1 = in->x + in->width, y1 = in->y + in->height;
    struct limit_point at;
    for (int step = 0; step < MOST_NEAR_STEPS; step++) {
        kept_surface_evaluate_again(surface, in->leaf, x, y, search->made, &at);
        struct vec d = vec_sub(at.s, search->p);
        double gx = vec_dot(d, at.su), gy = vec_dot(d, at.sv);
        double a = vec_dot(at.su, at.su), b = vec_dot(at.su, at.sv), c = vec_dot(at.sv, at.sv);
        double ha = a + vec_dot(d, at.suu), hb = b + vec_dot(d, at.suv),
               hc = c + vec_dot(d, at.svv);
        if (ha > 0.1 * a && hc > 0.1 * c && ha * hc - hb * hb > 0.1 * (a * c - b * b)) {
            a = ha; /* Newton's matrix; else Gauss and Newton's, which always leads downhill */
            b = hb;
            c = hc;
        }
        bool hold_x = is_held(x, in->x, x1, -gx), hold_y = is_held(y, in->y, y1, -gy);
        double det = a * c - b * b, dx = (b * gy - c * gx) / det, dy = (b * gx - a * gy) / det;
        if (hold_x || !(det > 0)) {
            dx = 0;
            dy = hold_y || !(c > 0) ? 0 : -gy / c;
        } else if (hold_y) {
            dx = -gx / a;
            dy = 0;
        }
        double nx = within(x + dx, in->x, x1), ny = within(y + dy, in->y, y1);
        bool is_last = fabs(nx - x) <= 1e-12 * in->width && fabs(ny - y) <= 1e-12 * in->height;
        x = nx;
        y = ny;
        if (is_last || !isfinite(x + y))
            break;
    }
    if (!isfinite(x + y))
        return false;
    kept_surface_evaluate_again(surface, in->leaf, x, y, search->made, &at);
    take_near(search, in->leaf, x, y, &at);
    return x > in->x && x < x1 && y > in->y && y < y1;
}

static void approach_rest(struct near_search *search, const struct rectangle *in)
{
    const struct kept_surface *surface = search->tree->surface;
    const struct corner_sector *sector = sector_of(search->tree, in->leaf);
    struct vec d = vec_sub(search->p, sector->vertex.s), n = sector->vertex.n;
    double away = vec_length(vec_mad(d, -vec_dot(d, n), n)), starts[3][2];
    take_near(search, in->leaf, 0, 0, &sector->vertex);
    if (away <= 1e-8 * sector->extent)
        return;
    corner_rest_starts(sector, surface, in->leaf, away, search->made, starts);
    bool is_found = false;
    for (int k = 0; k < 3 && !is_found; k++)
        is_found = approach(search, in, starts[k][0], starts[k][1]);
}

/* How far p is from a box along the unit vector n, at least. */
static double above_box(struct vec p, struct vec n, const struct tree_box *box)
{
    const double at[3] = {p.x, p.y, p.z}, by[3] = {n.x, n.y, n.z};
    double least = 0, most = 0;
    for (int k = 0; k < 3; k++) {
        double low = by[k] * ((double)box->least[k] - at[k]);
        double high = by[k] * ((double)box->most[k] - at[k]);
        least += smaller(low, high);
        most += larger(low, high);
    }
    return larger(larger(least, -most), 0);
}

/* A lower bound of the distance from a piece of a CORNER: by the sector of its leaf. */
static double distance_to_sector(const struct near_search *search, const struct tree_piece *piece)
{
    const struct corner_sector *sector = sector_of(search->tree, piece->leaf);
    double above = above_box(search->p, sector->vertex.n, &piece->box);
    if (piece->is_rest)
        above = larger(above, corner_rest_above(sector, search->p));
    return corner_sector_distance(sector, search->p, above);
}

static void approach_piece(struct near_search *search, const struct tree_piece *piece)
{
    const struct rectangle in = rectangle_of(piece);
    double limit = piece->at_border ? near_limit(search) : useful_limit(search);
    if (!(distance_to_box(search->p, &piece->box) < limit) ||
        (piece->is_corner && !(distance_to_sector(search, piece) < limit)))
        return;
    if (piece->is_rest)
        approach_rest(search, &in);
    else
        approach(search, &in, in.x + 0.5 * in.width, in.y + 0.5 * in.height);
}

static void approach_tree(struct near_search *search)
{
    const struct surface_tree *tree = search->tree;
    struct visit stack[MOST_DEPTH];
    int n = 0;
    stack[n++] = (struct visit){0, 0, 0};
    while (n > 0) {
        struct visit at = stack[--n];
        if (!(at.distance < near_limit(search)))
            continue;
        if (at.depth == tree->depth) {
            if (is_cancelled(tree))
                return;
            size_t end = tree_first(tree, at.depth, at.j + 1);
            for (size_t i = tree_first(tree, at.depth, at.j); i < end; i++)
                approach_piece(search, &tree->pieces[i]);
            continue;
        }
        struct visit next[2];
        for (int k = 0; k < 2; k++) {
            size_t j = 2 * at.j + (size_t)k;
            const struct tree_box *box = box_of(tree, at.depth + 1, j);
            next[k] = (struct visit){at.depth + 1, j, distance_to_box(search->p, box)};
        }
        int nearer = next[1].distance < next[0].distance;
        stack[n++] = next[!nearer];
        stack[n++] = next[nearer];
    }
}

static void find_near(struct near_search *search)
{
    for (int k = 0; k < AGREEMENTS; k++)
        search->best[k] = (struct closest){.kind = CLOSEST_NONE, .distance = DBL_MAX};
    search->border = DBL_MAX;
    if (search->tree->n_pieces)
        approach_tree(search);
}

void closest_nearest(const struct surface_tree *tree, struct vec p, struct closest *out)
{
    struct made_levels made;
    made_levels_init(&made);
    struct near_search search = {.tree = tree, .p = p, .made = &made};
    find_near(&search);
    *out = search.best[ANY_SIDE];
}

static void find_on_side(const struct surface_tree *tree, const struct closest_rules *rules,
                         struct vec p, struct vec n, struct made_levels *made, struct closest *out)
{
    struct near_search search = {.tree = tree, .rules = rules, .p = p, .n = n, .made = made};
    find_near(&search);
    const struct closest *agrees = &search.best[AGREES], *same = &search.best[SAME_SIDE],
                         *any = &search.best[ANY_SIDE];
    *out = agrees->distance <= same->distance + rules->tolerance ? *agrees : *same;
    if (any->distance <= rules->coincident && any->distance < out->distance - rules->tolerance)
        *out = *any;
    if (out->kind == CLOSEST_NONE)
        return;
    /* At a vertex of the border, a face that has only this vertex there may have been found. */
    if (search.border <= out->distance + rules->tolerance)
        out->kind = CLOSEST_BORDER;
    if (vec_dot(n, vec_sub(out->at.s, p)) < 0)
        out->distance = -out->distance;
}

void closest_find(const struct surface_tree *tree, const struct closest_rules *rules, struct vec p,
                  struct vec n, const struct closest_start *start, struct closest *out)
{
    *out = (struct closest){.kind = CLOSEST_NONE, .distance = DBL_MAX};
    if (!tree->n_pieces)
        return;
    struct made_levels made;
    made_levels_init(&made);
    struct search search = {
        .tree = tree, .rules = rules, .p = p, .n = n, .best = out, .made = &made};
    struct vec aside = fabs(n.x) < 0.7 ? (struct vec){1, 0, 0} : (struct vec){0, 1, 0};
    search.across[0] = vec_unit(vec_cross(n, aside));
    search.across[1] = vec_cross(n, search.across[0]);
    const double direction[3] = {n.x, n.y, n.z};
    for (int k = 0; k < 3; k++) {
        search.is_across[k] = fabs(direction[k]) < 1e-100;
        search.inverse[k] = 1 / direction[k];
    }
    search.reach = rules->reach;
    if (start->leaf != SIZE_MAX) {
        struct rectangle whole = {start->leaf, 0, 0, 1, 1};
        meet(&search, &whole, start->x, start->y);
    }
    bool is_same = out->kind == CLOSEST_RAY && out->distance == 0 && search.agreement > 0.99;
    if (!is_same)
        meet_tree(&search);
    if (out->kind == CLOSEST_NONE)
        find_on_side(tree, rules, p, n, &made, out);
}
