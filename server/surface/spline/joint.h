/* How smooth the surface is across the common boundary curve of two patches, by the geometry of
 * both sides. Pure, any thread; cannot fail. */
#ifndef SHEEN_SURFACE_SPLINE_JOINT_H
#define SHEEN_SURFACE_SPLINE_JOINT_H

enum joint_kind {
    JOINT_SMOOTH, /* normals and curvatures agree */
    /* Normals agree within 1e-6 rad. At one of the places the curvature across the curve jumps by
     * more than 1e-4 of the larger one, or of 0.001 / the curve's speed there if that is more. */
    JOINT_BEND,
    /* Normals differ at one of the places; or at none of the places do both sides have a normal. */
    JOINT_CREASE,
};

/* Compares both sides of a curve at nine places: edge `a_edge` of a patch with edge `b_edge` of
 * another, which runs the other way. Both patches are given by 16 Bezier points. */
enum joint_kind joint_kind_of(double a[16][3], unsigned a_edge, double b[16][3], unsigned b_edge);

#endif
