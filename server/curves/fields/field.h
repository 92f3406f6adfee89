/* Lines of a family on a surface as zero sets of polynomials. Where a patch s(u,v) is polynomial, so is its normal N =
 * s_u x s_v, of any length, and the mirrored view R = (N.N) V - 2 (V.N) N; a ray along R meets a line of a light where
 * a polynomial F in s, N and R vanishes. No square root is left:
 *
 *   plane      with the plane's normal m, the coordinate e on it and L = s - centre: F = A - p B, A = (e.L) (m.R) - (m.L)
 *              (e.R), B = m.R, for the line at e = p
 *   tunnel     around: across the axis, y a point of the circle, q = R and x = L there: F = (y - x) x q. Along: F = |W|^2 -
 *              radius^2 (a.R)^2, W = (a.R) x + (z - a.L) q
 *   azimuth    F = cos R_2 - sin R_1; elevation: F = (a.R)^2 - sin^2 (R.R), for 0 F = a.R
 *   isophote   F = (N.d)^2 - cos^2 (N.N) (d.d), for 90 degrees F = N.d
 *   silhouette F = V.N
 *
 * F vanishes also on lines that no ray meets: behind the surface, or at the opposite angle. field_residual() tells.
 * Degrees of F for bicubic patches: reflection on a plane or around a tunnel 16, along a tunnel 32, azimuth 13,
 * elevation 26; of highlight lines 8, 16, 5, 10; isophote 10, towards an eye 16; silhouette 8. (Elber 2001,
 * Graphical Models 63, has such zero sets for silhouettes, isoclines and reflection lines.)
 *
 * Pure, any thread, cannot fail. */
#ifndef SHEEN_FIELDS_FIELD_H
#define SHEEN_FIELDS_FIELD_H

#include <stdbool.h>

#include "server/curves/fields/bezier.h"
#include "server/curves/line_position.h"

enum field_form {
    FIELD_PLANE,
    FIELD_AROUND,    /* a tunnel's angle */
    FIELD_ALONG,     /* the place along a tunnel's axis */
    FIELD_AZIMUTH,   /* about an axis at infinity */
    FIELD_ELEVATION, /* at infinity, but 0 */
    FIELD_LEVEL,     /* elevation 0 */
    FIELD_ISOPHOTE,  /* but 90 degrees */
    FIELD_ISOPHOTE_90,
    FIELD_SILHOUETTE,
};

/* F = w[0] G[0] + w[1] G[1] + w[2] G[2], with polynomials G that all lines of a field share. */
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
    /* Where r[0] G[0] + ... times field_nets.facing is negative, no ray meets the line. All 0: not known. */
    double r[FIELD_TERMS];
};

/* The form of the field to which the line at `place` belongs: s' = 1/2 + a / w of a pattern that is turned by
 * `rotation_deg`. False if such lines are no polynomials: patterns on a tunnel or at infinity that are turned by another
 * angle than a multiple of 90 degrees. Lines of an isophote have no t. */
bool line_field_init(struct line_field *field, const struct line_map *map, double place);
/* The silhouette for the line eye of `map`. */
void silhouette_field_init(struct line_field *field, const struct line_map *map);

/* False if the light has no such place: beyond the ends of a light that is closed or at infinity. */
bool field_line_init(const struct line_field *field, double place, struct field_line *line);

struct field_nets {
    struct net g[FIELD_TERMS]; /* of equal degrees, plain; w of terms that a form has not are 0 */
    int n_terms;
    double facing;             /* 1, -1, or 0: not known for the whole net */
    double bound[FIELD_TERMS]; /* rounding is small against 2e-16 of it (LINE_NOISE) */
};

/* The doubles that nets of a field take at most. */
enum { FIELD_ROOM = 1 << 17 };

/* Makes the nets from those of a patch whose origin is `origin`. */
void field_make_nets(const struct line_field *field, struct net_room *room, struct vec origin,
                     const struct bezier_nets *patch, struct field_nets *nets);

/* Sets n_terms and the bounds alone, for points no farther than `reach` from `origin`. */
void field_find_bounds(const struct line_field *field, struct vec origin, double reach,
                       struct field_nets *nets);

/* Intervals of all values of the terms G over a patch or its side: the middle, then the radius. Cheap, and wide where the
 * normal turns much. */
struct field_box {
    double g[FIELD_TERMS][2];
    int n_terms;
};
void field_make_box(const struct line_field *field, struct vec origin,
                    const struct bezier_box *patch, struct field_box *box);
/* The sign of F throughout, if the intervals show that it is one; else 0. */
int field_box_sign(const struct field_box *box, const struct field_line *line);

/* F and its derivatives by u and v at a point of a patch. */
void field_jet(const struct line_field *field, const struct field_line *line, struct vec origin,
               const struct bezier_jet *at, double out[3]);

/* The sum of the terms' bounds for a line. */
double field_bound(const struct field_nets *nets, const struct field_line *line);

/* The difference between the place of a surface point (world, unit normal) on the light and the line's, in places; the
 * shorter way around where the light is closed. NaN where the ray does not meet the light, or meets the opposite
 * angle. For a silhouette the cosine between view and normal. */
double field_residual(const struct line_field *field, const struct field_line *line, struct vec x,
                      struct vec n);

#endif
