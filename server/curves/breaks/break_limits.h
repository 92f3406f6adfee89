/* The limits of breaks. Plain data. */
#ifndef SHEEN_CURVES_BREAKS_BREAK_LIMITS_H
#define SHEEN_CURVES_BREAKS_BREAK_LIMITS_H

/* An edge is out of tolerance where it exceeds one of these. All are above 0. */
struct break_limits {
    double gap;       /* units */
    double angle_deg; /* between the normals of both sides */
    double curvature_percent;
};

#endif
