#include "server/curves/compare/surface_tree.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/* A part of a leaf is cut until its derivatives turn by at most this over a piece, rad. */
static const double MOST_TURN = 0.35;
/* Pieces of a node without children, and of a subtree that is sorted in one go. */
enum { PIECES_OF_NODE = 4, PIECES_OF_SUBTREE = 4096 };

bool surface_tree_init(struct surface_tree *tree, const struct kept_surface *surface,
                       struct error *error)
{
    *tree = (struct surface_tree){.surface = surface};
    tree->n_pieces_of = calloc(surface->n_leaves + 1, sizeof *tree->n_pieces_of);
    tree->first_piece = calloc(surface->n_leaves + 1, sizeof *tree->first_piece);
    return (tree->n_pieces_of && tree->first_piece) ||
           error_set(error, ERROR_SERVER, "no memory for a surface's tree");
}

void surface_tree_finish(struct surface_tree *tree)
{
    free(tree->n_pieces_of);
    free(tree->first_piece);
    free(tree->sectors);
    free(tree->pieces);
    free(tree->boxes);
    *tree = (struct surface_tree){0};
}

size_t surface_tree_bytes(const struct surface_tree *tree)
{
    return (tree->surface->n_leaves + 1) * (sizeof *tree->first_piece + sizeof *tree->n_pieces_of) +
           tree->n_pieces * sizeof *tree->pieces +
           (tree->sectors ? tree->surface->n_corners * sizeof *tree->sectors : 0) +
           (tree->boxes ? ((size_t)2 << tree->depth) * sizeof *tree->boxes : 0);
}

/* The largest angle between the mean of the net's differences in one direction and one of them. */
static double turn_of(const struct vec net[16], int stride, int across)
{
    struct vec d[12], mean = {0, 0, 0};
    for (int k = 0; k < 12; k++) {
        const struct vec *p = net + (k / 3) * across + (k % 3) * stride;
        d[k] = vec_sub(p[stride], p[0]);
        mean = vec_add(mean, d[k]);
    }
    double most = 0;
    for (int k = 0; k < 12; k++)
        most = fmax(most, atan2(vec_length(vec_cross(mean, d[k])), vec_dot(mean, d[k])));
    return most;
}

/* The number of pieces along each side of a part, at most `most`. */
static unsigned cuts_of(const struct vec net[16], unsigned most)
{
    double turn = fmax(turn_of(net, 1, 4), turn_of(net, 4, 1));
    unsigned cuts = 1;
    while (cuts < most && turn > MOST_TURN * cuts)
        cuts *= 2;
    return cuts;
}

void surface_tree_divide(struct surface_tree *tree, size_t leaf)
{
    struct kept_part parts[KEPT_PARTS];
    unsigned n = kept_surface_parts(tree->surface, leaf, parts);
    uint32_t *n_pieces = tree->n_pieces_of[leaf];
    for (unsigned k = 0; k < n; k++) {
        struct vec net[16];
        if (!parts[k].is_rest)
            kept_surface_net(tree->surface, leaf, &parts[k], net);
        for (unsigned i = 0; i < TREE_CUTS; i++) {
            unsigned cuts = parts[k].is_rest ? 1 : cuts_of(net, 1u << i);
            n_pieces[i] += cuts * cuts;
        }
    }
}

/* Numbers the pieces for at most 4^n pieces of a part, and chooses the depth of the tree. Returns the bytes of pieces,
 * boxes and sectors; SIZE_MAX if there are too many. */
static size_t lay_out(struct surface_tree *tree, unsigned n)
{
    size_t total = 0;
    for (size_t leaf = 0; leaf < tree->surface->n_leaves; leaf++) {
        tree->first_piece[leaf] = (uint32_t)total;
        total += tree->n_pieces_of[leaf][n];
        if (total > UINT32_MAX)
            return SIZE_MAX;
    }
    tree->n_pieces = total;
    tree->most_cuts = 1u << n;
    tree->depth = tree->top_depth = 0;
    while (total >> tree->depth > PIECES_OF_NODE)
        tree->depth++;
    while (total >> tree->top_depth > PIECES_OF_SUBTREE)
        tree->top_depth++;
    return total * sizeof *tree->pieces + ((size_t)2 << tree->depth) * sizeof *tree->boxes +
           tree->surface->n_corners * sizeof *tree->sectors;
}

bool surface_tree_allocate(struct surface_tree *tree, size_t most_bytes, struct error *error)
{
    unsigned n = TREE_CUTS - 1;
    size_t bytes = lay_out(tree, n);
    while (n > 0 && bytes > most_bytes)
        bytes = lay_out(tree, --n);
    if (bytes > most_bytes)
        return error_set(error, ERROR_SERVER,
                         "the surface's tree needs %zu MB, more than the %zu MB that a computation "
                         "may take",
                         bytes >> 20, most_bytes >> 20);
    tree->pieces = calloc(tree->n_pieces + 1, sizeof *tree->pieces);
    tree->boxes = calloc((size_t)2 << tree->depth, sizeof *tree->boxes);
    tree->sectors = calloc(tree->surface->n_corners + 1, sizeof *tree->sectors);
    return (tree->pieces && tree->boxes && tree->sectors) ||
           error_set(error, ERROR_SERVER, "no memory for a surface's tree");
}

/* The blossom of a cubic with Bezier points `stride` apart. */
static struct vec blossom(const struct vec *p, int stride, double a, double b, double c)
{
    struct vec q[4];
    for (int k = 0; k < 4; k++)
        q[k] = p[k * stride];
    const double at[3] = {a, b, c};
    for (int step = 0; step < 3; step++)
        for (int k = 0; k < 3 - step; k++)
            q[k] = vec_mad(vec_scale(q[k], 1 - at[step]), at[step], q[k + 1]);
    return q[0];
}

static void cut(const struct vec *p, int stride, double a, double b, struct vec *out)
{
    out[0] = blossom(p, stride, a, a, a);
    out[stride] = blossom(p, stride, a, a, b);
    out[2 * stride] = blossom(p, stride, a, b, b);
    out[3 * stride] = blossom(p, stride, b, b, b);
}

static struct tree_box empty_box(void)
{
    return (struct tree_box){{FLT_MAX, FLT_MAX, FLT_MAX}, {-FLT_MAX, -FLT_MAX, -FLT_MAX}};
}

/* Grows a box by a point, rounded outwards. */
static void grow(struct tree_box *box, struct vec p)
{
    const double at[3] = {p.x, p.y, p.z};
    for (int k = 0; k < 3; k++) {
        float least = nextafterf((float)at[k], -FLT_MAX);
        float most = nextafterf((float)at[k], FLT_MAX);
        box->least[k] = fminf(box->least[k], least);
        box->most[k] = fmaxf(box->most[k], most);
    }
}

static struct tree_box box_of_net(const struct vec net[16], double a, double b, double side)
{
    struct vec rows[16], cell[16];
    for (int k = 0; k < 4; k++)
        cut(net + 4 * k, 1, a, a + side, rows + 4 * k);
    for (int k = 0; k < 4; k++)
        cut(rows + k, 4, b, b + side, cell + k);
    struct tree_box box = empty_box();
    for (int k = 0; k < 16; k++)
        grow(&box, cell[k]);
    return box;
}

/* The box of what the kept levels leave of a CORNER: that of the next level and of the vertex, to which all further
 * levels contract; a tenth larger, because they need not do so in proportion. */
static struct tree_box box_of_rest(const struct kept_surface *surface, size_t leaf,
                                   const struct kept_part *rest)
{
    struct limit_point vertex;
    kept_surface_evaluate(surface, leaf, 0, 0, &vertex);
    struct tree_box box = empty_box();
    grow(&box, vertex.s);
    for (int k = 1; k < 4; k++) {
        double half = 0.5 * rest->width;
        struct kept_part part = {k & 1 ? half : 0, k & 2 ? half : 0, half, half, false};
        struct vec net[16];
        kept_surface_net(surface, leaf, &part, net);
        for (int i = 0; i < 16; i++)
            grow(&box, vec_add(vertex.s, vec_scale(vec_sub(net[i], vertex.s), 1.1)));
    }
    return box;
}

/* True if the surface ends at an edge of the leaf. */
static bool has_border(const struct kept_surface *surface, size_t leaf)
{
    static const double middles[4][2] = {{0.5, 0}, {1, 0.5}, {0.5, 1}, {0, 0.5}};
    for (int edge = 0; edge < 4; edge++)
        if (kept_surface_at_border(surface, leaf, middles[edge][0], middles[edge][1]))
            return true;
    return false;
}

/* The pieces of a part that is no rest; `piece` has what all pieces of the leaf have in common. Returns their end. */
static struct tree_piece *fill_part(const struct surface_tree *tree, const struct kept_part *part,
                                    struct tree_piece piece, struct tree_piece *to)
{
    struct vec net[16];
    kept_surface_net(tree->surface, piece.leaf, part, net);
    unsigned cuts = cuts_of(net, tree->most_cuts);
    double side = 1.0 / cuts;
    piece.width = (float)(side * part->width);
    piece.height = (float)(side * part->height);
    for (unsigned i = 0; i < cuts * cuts; i++) {
        double a = (i % cuts) * side, b = (i / cuts) * side;
        piece.box = box_of_net(net, a, b, side);
        piece.x = (float)(part->x + a * part->width);
        piece.y = (float)(part->y + b * part->height);
        *to++ = piece;
    }
    return to;
}

void surface_tree_fill(struct surface_tree *tree, size_t leaf)
{
    const struct kept_surface *surface = tree->surface;
    struct kept_part parts[KEPT_PARTS];
    unsigned n = kept_surface_parts(surface, leaf, parts);
    struct tree_piece *to = tree->pieces + tree->first_piece[leaf];
    struct tree_piece piece = {.leaf = (uint32_t)leaf,
                               .is_corner = kept_node(surface, leaf)->kind == LIMIT_CORNER,
                               .at_border = has_border(surface, leaf)};
    if (piece.is_corner)
        corner_sector_init(&tree->sectors[surface->leaves[leaf].corner], surface, leaf);
    for (unsigned k = 0; k < n; k++) {
        const struct kept_part *part = &parts[k];
        if (!part->is_rest) {
            to = fill_part(tree, part, piece, to);
            continue;
        }
        *to = piece;
        to->is_rest = true;
        to->box = box_of_rest(surface, leaf, part);
        to->width = (float)part->width;
        to->height = (float)part->height;
        to++;
    }
}

static float middle(const struct tree_piece *piece, int axis)
{
    return 0.5f * piece->box.least[axis] + 0.5f * piece->box.most[axis];
}

/* The axis along which the middles of the pieces extend farthest. */
static int longest_axis(const struct tree_piece *pieces, size_t n)
{
    struct tree_box box = empty_box();
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < 3; k++) {
            box.least[k] = fminf(box.least[k], middle(&pieces[i], k));
            box.most[k] = fmaxf(box.most[k], middle(&pieces[i], k));
        }
    int longest = 0;
    for (int k = 1; k < 3; k++)
        if (box.most[k] - box.least[k] > box.most[longest] - box.least[longest])
            longest = k;
    return longest;
}

/* Moves the `nth` pieces with the least middles to the front (Hoare's selection). */
static void select_least(struct tree_piece *pieces, size_t n, size_t nth, int axis)
{
    size_t low = 0, high = n; /* the place `nth` is in [low, high) */
    while (high - low > 1) {
        float a = middle(&pieces[low], axis), b = middle(&pieces[low + (high - low) / 2], axis),
              c = middle(&pieces[high - 1], axis);
        float pivot = fmaxf(fminf(a, b), fminf(fmaxf(a, b), c));
        size_t i = low, j = high - 1;
        for (;;) {
            while (middle(&pieces[i], axis) < pivot)
                i++;
            while (middle(&pieces[j], axis) > pivot)
                j--;
            if (i >= j)
                break;
            struct tree_piece swapped = pieces[i];
            pieces[i++] = pieces[j];
            pieces[j--] = swapped;
        }
        size_t cut_at = j + 1 > low && j + 1 < high ? j + 1 : (low + high) / 2;
        if (nth < cut_at)
            high = cut_at;
        else
            low = cut_at;
    }
}

/* Splits node j of depth d into its children. */
static void split_node(struct surface_tree *tree, unsigned d, size_t j)
{
    size_t first = tree_first(tree, d, j), end = tree_first(tree, d, j + 1);
    size_t half = tree_first(tree, d + 1, 2 * j + 1);
    struct tree_piece *pieces = tree->pieces + first;
    if (end - first > 1)
        select_least(pieces, end - first, half - first, longest_axis(pieces, end - first));
}

static void merge(struct tree_box *into, const struct tree_box *box)
{
    for (int k = 0; k < 3; k++) {
        into->least[k] = fminf(into->least[k], box->least[k]);
        into->most[k] = fmaxf(into->most[k], box->most[k]);
    }
}

static struct tree_box *box_at(const struct surface_tree *tree, unsigned d, size_t j)
{
    return &tree->boxes[((size_t)1 << d) - 1 + j];
}

static void join_node(struct surface_tree *tree, unsigned d, size_t j)
{
    struct tree_box box = *box_at(tree, d + 1, 2 * j);
    merge(&box, box_at(tree, d + 1, 2 * j + 1));
    *box_at(tree, d, j) = box;
}

size_t surface_tree_split(struct surface_tree *tree)
{
    for (unsigned d = 0; d < tree->top_depth; d++)
        for (size_t j = 0; j < (size_t)1 << d; j++)
            split_node(tree, d, j);
    return (size_t)1 << tree->top_depth;
}

void surface_tree_sort(struct surface_tree *tree, size_t subtree)
{
    unsigned top = tree->top_depth;
    for (unsigned d = top; d < tree->depth; d++)
        for (size_t j = subtree << (d - top); j < (subtree + 1) << (d - top); j++)
            split_node(tree, d, j);
    unsigned last = tree->depth;
    for (size_t j = subtree << (last - top); j < (subtree + 1) << (last - top); j++) {
        struct tree_box box = empty_box();
        for (size_t i = tree_first(tree, last, j); i < tree_first(tree, last, j + 1); i++)
            merge(&box, &tree->pieces[i].box);
        *box_at(tree, last, j) = box;
    }
    for (unsigned d = last; d-- > top;)
        for (size_t j = subtree << (d - top); j < (subtree + 1) << (d - top); j++)
            join_node(tree, d, j);
}

void surface_tree_join(struct surface_tree *tree)
{
    for (unsigned d = tree->top_depth; d-- > 0;)
        for (size_t j = 0; j < (size_t)1 << d; j++)
            join_node(tree, d, j);
}
