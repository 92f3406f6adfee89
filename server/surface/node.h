/* What a limit surface is made of: nodes, and what lies across the edges of its faces. Plain data
 * that devices copy to their own memory as it is.
 *
 * The surface is a list of nodes. The first nodes are the roots of the faces, in order; a face is
 * what users know by a number and by (u,v): for a subdivision surface OpenSubdiv's Ptex face (a
 * quad is one, an n-gon is n). A node is REGULAR  one bicubic B-spline patch of 16 points i,j =
 * -1..2; CORNER   a quad with one extraordinary vertex, at local (0,0): levels of 24 points each,
 * in a frame of the vertex and relative to its limit position (README.md 3); STRIP    a quad along
 * a semi-sharp crease at local v = 0: `levels` + 1 patches across it (README.md 5); SPLIT    four
 * children, which cover the quarters at (0,0) (1,0) (1,1) (0,1); HOLE     no surface. All five are
 * of quads. A node of another domain (a triangle) or of another degree is one more kind: what a
 * kind's texels hold is known to patch.c and evaluate.c here and to the devices' shaders, and
 * nothing else looks at them. */
#ifndef SHEEN_SURFACE_NODE_H
#define SHEEN_SURFACE_NODE_H

#include <stdbool.h>
#include <stdint.h>

/* How many levels a CORNER has: as many as leave out less than a pixel where pixels are 2^-24 of
 * the face, and never fewer than the least (README.md 3.4). */
#define LIMIT_MIN_LEVELS 32
#define LIMIT_MAX_LEVELS 41
#define LIMIT_NO_NORMAL 0x80u /* added to a CORNER's levels */
#define LIMIT_NO_FACE UINT32_MAX

enum limit_kind { LIMIT_REGULAR, LIMIT_CORNER, LIMIT_SPLIT, LIMIT_HOLE, LIMIT_STRIP, LIMIT_KINDS };

/* 48 bytes, three RGBA32UI texels on the GPU. */
struct limit_node {
    double origin[3]; /* world; the node's points are relative to it */
    uint32_t first;   /* kinds with points: index of its first texel; SPLIT: of its first child */
    uint32_t face;    /* the face that it is part of */
    uint32_t cell;    /* x | y << 16: which cell of the 2^depth by 2^depth grid over the face */
    uint8_t kind;     /* enum limit_kind */
    uint8_t depth;    /* the node spans 2^-depth of its face */
    uint8_t rotation; /* local (0,0) is this corner of the cell, 0..3 */
    uint8_t levels;   /* STRIP: its patches but one; CORNER: its levels, plus LIMIT_NO_NORMAL where
                         the surface has no single normal at the vertex */
    uint32_t ngon_size;   /* of a root: corners of its n-gon, 0 where the face is a whole quad */
    uint16_t ngon_corner; /* of a root: which corner of the n-gon is the face's corner 0 */
    uint16_t borders;     /* of the face: four bits an edge, see below */
};

/* Along an edge of a face the surface may end, or have a crease: 0 where it has neither, else the
 * levels that the crease takes (it is rounded over 2^-levels of the face), LIMIT_BORDER_SHARP where
 * the surface ends or the crease is infinitely sharp. Edge e has the bits from 4 e on. */
#define LIMIT_BORDER_SHARP 15u

/* What lies across edge e (corner e to corner e + 1) of a face: the other face << 2 | its edge
 * there, or LIMIT_NO_FACE. A quad beside an n-gon borders two of its faces: the one named is at the
 * end of edge e, the next one of the n-gon (by ngon_corner) at its start. 16 bytes, one RGBA32UI
 * texel. */
struct limit_adjacency {
    uint32_t across[4];
};

/* How far a piece of surface reaches and bends, in units: for culling, and to choose the grid that
 * it is drawn with. Cut into m x n cells the piece lies within (u / m^2 + 2 mixed / (m n) + v /
 * n^2) / 8 of their triangles, and a curve on it along u or v, as its borders are, within border_u
 * / (8 m^2) or border_v / (8 n^2) (README.md 6.1). */
struct limit_bound {
    float radius; /* of a sphere about the piece's origin that holds its control points */
    float u, mixed, v;
    float border_u, border_v;
};

/* The levels of a CORNER. */
static inline unsigned limit_levels(const struct limit_node *node)
{
    return node->levels & ~LIMIT_NO_NORMAL;
}

/* Whether the node holds points of the surface itself: no SPLIT, no HOLE. */
static inline bool limit_has_points(const struct limit_node *node)
{
    return node->kind != LIMIT_SPLIT && node->kind != LIMIT_HOLE;
}

#endif
