/* Makes bicubic Bezier patches of what is given at their corners or along their sides: Hermite and
 * Coons patches. Exact but for rounding, in double. Parameters are u and v in [0,1]. Pure, any
 * thread. Internal to server/cage. */
#ifndef SHEEN_CAGE_BUILD_PATCH_BLENDS_H
#define SHEEN_CAGE_BUILD_PATCH_BLENDS_H

/* The corner of a Hermite patch: the point, the derivatives by u and v, and the mixed one, the
 * twist. */
struct patch_corner {
    double p[3], pu[3], pv[3], puv[3];
};

/* A bicubic Hermite patch by its corners at (0,0) (1,0) (0,1) (1,1). With all twists zero it is
 * Ferguson's (Ferguson, Multivariable curve interpolation, JACM 11, 1964). */
void patch_from_hermite(const struct patch_corner corner[4], double out[16][3]);

/* The sides of a Coons patch, as cubic Bezier curves: v = 0 and v = 1 along u, u = 0 and u = 1
 * along v. */
enum patch_side { SIDE_V0, SIDE_V1, SIDE_U0, SIDE_U1, N_PATCH_SIDES };

/* Coons' bilinearly blended patch of four sides (Farin, chapter 22): the sum of both ruled surfaces
 * minus the bilinear surface of the corners. Where sides do not meet at a corner, the mean is its
 * point. */
void patch_from_coons(double side[N_PATCH_SIDES][4][3], double out[16][3]);

/* Coons' bicubically blended patch of four sides and the derivatives across them (by v along
 * SIDE_V0 and SIDE_V1, by u along the others), cubic Bezier curves as well. Where the derivatives
 * of both sides at a corner differ, the mean is taken, and likewise of twists. */
void patch_from_bicubic_coons(double side[N_PATCH_SIDES][4][3], double across[N_PATCH_SIDES][4][3],
                              double out[16][3]);

#endif
