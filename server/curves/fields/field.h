/* Lines of a family on a surface as zero sets of functions. Where a patch s(u,v) is polynomial, so
 * is its normal N = s_u x s_v, of any length, and the mirrored view R = (N.N) V - 2 (V.N) N; a ray
 * along R meets a line of a light where a function F of s, N and R vanishes:
 *
 *   plane      with the plane's normal m, the coordinate e on it and L = s - centre:
 *              F = A - p B, A = (e.L) (m.R) - (m.L) (e.R), B = m.R, for the line at e = p
 *   tunnel     around: across the axis, y a point of the circle, q = R and x = L there:
 *              F = (y - x) x q. Along: F = |W|^2 - radius^2 (a.R)^2, W = (a.R) x + (z - a.L) q
 *   azimuth    F = cos R_2 - sin R_1
 *   elevation  F = a.R - sin |R|, where |R| = (N.N) |V|; of highlight lines |R| = |N|
 *   isophote   F = N.d - cos |N| |d|
 *   silhouette F = V.N
 *
 * F is also 0 on lines that no ray meets: behind the surface, and on a tunnel where the ray comes
 * from outside. There field_residual() is NaN. (Elber 2001, Graphical Models 63, has such zero sets
 * for silhouettes, isoclines and reflection lines; he squares the equations instead of taking
 * roots; this adds the lines of the opposite angle.)
 *
 * F is never expanded as a polynomial: its degree would be up to 32, and digits would be lost where
 * N is short. F is evaluated at points, and over a piece it is bounded by a Taylor model of order 3
 * (numbers.h).
 *
 * Pure, any thread, cannot fail. */
#ifndef SHEEN_FIELDS_FIELD_H
#define SHEEN_FIELDS_FIELD_H

#include <stdbool.h>

#include "server/curves/fields/bezier.h"
#include "server/curves/fields/numbers.h"
#include "server/curves/fields/piece.h"
#include "server/curves/line_position.h"

enum field_form {
    FIELD_PLANE,
    FIELD_AROUND,    /* a tunnel's angle */
    FIELD_ALONG,     /* the place along a tunnel's axis */
    FIELD_AZIMUTH,   /* about an axis at infinity */
    FIELD_ELEVATION, /* at infinity */
    FIELD_ISOPHOTE,
    FIELD_SILHOUETTE,
};

/* F = w[0] G[0] + w[1] G[1] + w[2] G[2], with functions G that all lines of a field share. */
enum { FIELD_TERMS = 3 };

struct line_field {
    enum field_form form;
    struct line_map map;
    struct vec across; /* PLANE: what is multiplied with a place's offset from the light's centre */
    bool by_t;         /* the place is the light's t, not its s; PLANE: of the rotated pattern */
    double turn;       /* PLANE: radians by which the pattern is turned */
};

/* A line of a field. */
struct field_line {
    double place; /* on the light: s' of shaders/README.md, "Patterns" */
    double w[FIELD_TERMS];
    /* Where r[0] G[0] + ... times field_range.facing is negative, no ray meets the line. All 0: not
     * known. */
    double r[FIELD_TERMS];
};

/* Initialises the field of the lines s' = a / w + 1/2 (shaders/README.md, Patterns) of
 * map->pattern. Returns false if these lines have no F: if a pattern on a tunnel, on an isophote or
 * at infinity is turned by an angle that is no multiple of 90 degrees, or if it is turned so that
 * lines of an isophote would need t. */
bool line_field_init(struct line_field *field, const struct line_map *map);
/* The silhouette for the line eye of `map`. */
void silhouette_field_init(struct line_field *field, const struct line_map *map);

/* Returns false if the light has no such place: the place lies beyond the ends of a light that is
 * closed or at infinity. */
bool field_line_init(const struct line_field *field, double place, struct field_line *line);

/* The terms over a piece or a segment, which all lines share: numbers of NUMBERS_RANGE. */
struct field_range {
    double g[FIELD_TERMS][RANGE_SIZE];
    int n_terms;
    double facing; /* 1, -1, or 0: not known for the whole piece */
};
void field_find_range(const struct line_field *field, struct vec origin,
                      const struct piece_range *piece, struct field_range *range);

/* F of a line: a number of NUMBERS_RANGE. */
void field_line_range(const struct field_range *range, const struct field_line *line,
                      double out[RANGE_SIZE]);
/* The sign of F throughout, if the terms' ranges show that it is one; else 0. Cheap, and less often
 * known than by field_line_range(). */
int field_quick_sign(const struct field_range *range, const struct field_line *line);
/* True if no ray meets the line anywhere on the piece. */
bool field_is_never_met(const struct field_range *range, const struct field_line *line);

/* Bounds of the terms, for points whose distance from `origin` is at most `reach` in each
 * coordinate, and for normals whose coordinates are at most 1. The rounding error of a term is much
 * smaller than 2e-16 (LINE_NOISE) times its bound. */
struct field_bounds {
    double g[FIELD_TERMS];
    int n_terms;
};
void field_find_bounds(const struct line_field *field, struct vec origin, double reach,
                       struct field_bounds *bounds);
/* The sum of the terms' bounds for a line. */
double field_bound(const struct field_bounds *bounds, const struct field_line *line);

/* F and its derivatives by u and v at a point of a patch. The normal's largest coordinate is from
 * 0.5 to 1. */
void field_jet(const struct line_field *field, const struct field_line *line, struct vec origin,
               const struct bezier_jet *at, double out[3]);

/* The difference between the place of a surface point (world, unit normal) on the light and the
 * line's, in places; the shorter way around where the light is closed. NaN where the ray does not
 * meet the light, or meets the opposite azimuth. For a silhouette the cosine between view and
 * normal. */
double field_residual(const struct line_field *field, const struct field_line *line, struct vec x,
                      struct vec n);

#endif
