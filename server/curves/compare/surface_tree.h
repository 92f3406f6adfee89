/* A tree of boxes over a surface, for closest.h. Its leaves are pieces: rectangles of patches that
 * bend so little that Newton's method finds the only solution from the middle.
 *
 * Building it takes steps, so that it can be cut into slices: surface_tree_divide() for each leaf
 * of the surface says how many pieces there are; surface_tree_allocate(); surface_tree_fill() for
 * each leaf; surface_tree_split(); surface_tree_sort() for each subtree; surface_tree_join(). Steps
 * for leaves and subtrees may run at the same time; the others are one thread's. A finished tree is
 * read-only. */
#ifndef SHEEN_CURVES_COMPARE_SURFACE_TREE_H
#define SHEEN_CURVES_COMPARE_SURFACE_TREE_H

#include "server/curves/compare/kept_surface.h"
#include "server/curves/compare/sector.h"
#include "server/curves/computation.h"

/* An axis-parallel box: least x, y, z, and largest x, y, z. */
struct tree_box {
    float least[3], most[3];
};

struct tree_piece {
    struct tree_box box; /* contains the piece */
    uint32_t leaf;
    bool is_rest;   /* the rest about a CORNER's vertex */
    bool is_corner; /* a part of a CORNER */
    bool at_border; /* the surface ends at an edge of the leaf */
    float x, y, width,
        height; /* its rectangle of the leaf; all of them are sums of powers of two */
};

/* A part of a leaf is cut into 1, 4, 16 or 64 pieces: at most 4^n of them for the index n of
 * these. */
enum { TREE_CUTS = 4 };

struct surface_tree {
    const struct kept_surface *surface; /* outlives the tree */
    struct computation *computation;    /* searches end early once it is cancelled; NULL: never */
    /* [n_leaves]: pieces of each leaf if a part has at most 4^n of them. */
    uint32_t (*n_pieces_of)[TREE_CUTS];
    uint32_t *first_piece;         /* [n_leaves] */
    unsigned most_cuts;            /* along each side of a part: 1, 2, 4 or 8 */
    struct corner_sector *sectors; /* [surface->n_corners] */
    struct tree_piece *pieces;
    size_t n_pieces;
    /* A complete binary tree: the children of node i are 2 i + 1 and 2 i + 2; the node j of depth d
     * has the pieces from n_pieces j / 2^d on. */
    struct tree_box *boxes;
    unsigned depth;     /* of the nodes that have no children */
    unsigned top_depth; /* of the roots of the subtrees that are sorted separately */
};

bool surface_tree_init(struct surface_tree *tree, const struct kept_surface *surface,
                       struct error *error);
void surface_tree_finish(struct surface_tree *tree);
void surface_tree_divide(struct surface_tree *tree, size_t leaf);
/* Where pieces and boxes would need more than `most_bytes`, parts are cut into fewer pieces, in
 * which Newton's method may miss a solution. False with ERROR_SERVER when even one piece of each
 * part needs more. */
bool surface_tree_allocate(struct surface_tree *tree, size_t most_bytes, struct error *error);
void surface_tree_fill(struct surface_tree *tree, size_t leaf);
/* Returns the number of subtrees. */
size_t surface_tree_split(struct surface_tree *tree);
void surface_tree_sort(struct surface_tree *tree, size_t subtree);
void surface_tree_join(struct surface_tree *tree);
size_t surface_tree_bytes(const struct surface_tree *tree);

/* The pieces of node j of depth d. */
static inline size_t tree_first(const struct surface_tree *tree, unsigned d, size_t j)
{
    return (size_t)(((unsigned __int128)tree->n_pieces * j) >> d);
}

#endif
