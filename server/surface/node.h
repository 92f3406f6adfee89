/* The elements of a limit surface: nodes, and the neighbours of faces. Plain data, which devices
 * copy to their own memory unchanged.
 *
 * A surface is an array of nodes. The first nodes are the roots of the faces, in order. A face is
 * what users address by a number and (u,v); for a subdivision surface it is OpenSubdiv's Ptex face
 * (a quad is one, an n-gon is n). The kinds of node are:
 *
 * REGULAR  one bicubic B-spline patch of 16 points i,j = -1..2
 * CORNER   a quad with one extraordinary vertex, at local (0,0): levels of 24 points each, in a frame
 *          of the vertex and relative to its limit position (README.md 3)
 * STRIP    a quad along a semi-sharp crease at local v = 0: `levels` + 1 patches across it (README.md 5)
 * SPLIT    four children, which cover the quarters at (0,0) (1,0) (1,1) (0,1)
 * HOLE     no surface
 *
 * All five are quads. A node with another domain (a triangle) or another degree would be one more
 * kind. Only patch.c, evaluate.c and the devices' shaders know what the texels of a kind
 * contain. */
#ifndef SHEEN_SURFACE_NODE_H
#define SHEEN_SURFACE_NODE_H

#include <stdbool.h>
#include <stdint.h>

/* The number of levels of a CORNER: so many that the rest is smaller than a pixel if a pixel is
 * 2^-24 of the face, but at least the minimum (README.md 3.4). */
#define LIMIT_MIN_LEVELS 32
#define LIMIT_MAX_LEVELS 41
#define LIMIT_NO_NORMAL 0x80u /* flag in a CORNER's `levels` */
#define LIMIT_NO_FACE UINT32_MAX

enum limit_kind { LIMIT_REGULAR, LIMIT_CORNER, LIMIT_SPLIT, LIMIT_HOLE, LIMIT_STRIP, LIMIT_KINDS };

/* 48 bytes, three RGBA32UI texels on the GPU. */
struct limit_node {
    double origin[3]; /* world position to which the node's points are relative */
    uint32_t first;   /* kinds with points: index of the first texel; SPLIT: of the first child */
    uint32_t face;    /* the face that contains it */
    /* X | y << 16: its cell in the grid of 2^depth by 2^depth cells over the face. */
    uint32_t cell;
    uint8_t kind;     /* enum limit_kind */
    uint8_t depth;    /* the node's side is 2^-depth of the face's */
    uint8_t rotation; /* the corner of the cell, 0 to 3, at local (0,0) */
    /* STRIP: number of patches minus one; CORNER: number of levels, plus LIMIT_NO_NORMAL if the
     * surface has no single normal at the vertex. */
    uint8_t levels;
    uint32_t ngon_size;   /* root: corners of its n-gon; 0: the face is a whole quad */
    uint16_t ngon_corner; /* root: the corner of the n-gon at the face's corner 0 */
    uint16_t borders;     /* the borders of the face: four bits for each edge, see below */
};

/* At an edge of a face the surface may end or have a crease. The value is 0 for neither; else the
 * number of levels that the crease takes (it is rounded within 2^-levels of the face); or
 * LIMIT_BORDER_SHARP if the surface ends or the crease is infinitely sharp. Edge e has the bits
 * from 4 e on. An edge with 0 and without a neighbour is one point, such as a pole. */
#define LIMIT_BORDER_SHARP 15u

/* The neighbour across edge e (corner e to corner e + 1) of a face: its number << 2 | its edge, or
 * LIMIT_NO_FACE. A quad beside an n-gon borders two of its faces: the one stored is at the end of
 * edge e, the next one of the n-gon (by ngon_corner) is at its start. 16 bytes, one RGBA32UI
 * texel. */
struct limit_adjacency {
    uint32_t across[4];
};

/* How far a piece of surface extends and how much it bends, in world units: for culling, and to
 * choose the grid with which it is drawn. Cut into m x n cells, the piece lies within (u / m^2 + 2
 * mixed / (m n) + v / n^2) / 8 of their triangles. A curve on it along u or v, such as a border,
 * lies within border_u / (8 m^2) or border_v / (8 n^2) (README.md 6.1). */
struct limit_bound {
    float radius; /* radius of a sphere about the piece's origin that contains its control points */
    float u, mixed, v;
    float border_u, border_v;
};

/* The number of levels of a CORNER. */
static inline unsigned limit_levels(const struct limit_node *node)
{
    return node->levels & ~LIMIT_NO_NORMAL;
}

/* True if the node has points of the surface: all kinds except SPLIT and HOLE. */
static inline bool limit_has_points(const struct limit_node *node)
{
    return node->kind != LIMIT_SPLIT && node->kind != LIMIT_HOLE;
}

#endif
