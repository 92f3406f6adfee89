#include "tests/oracle/solve.h"

#include <cmath>

bool solve_ray(const osd_oracle &oracle, const projector &camera, double x, double y, int steps,
               uint32_t face, double u, double v, osd_sample *sample)
{
    vec3 origin, d;
    camera.ray(x, y, &origin, &d);
    vec3 h = normalized(cross(d, std::fabs(d.x) < 0.6 ? vec3{1, 0, 0} : vec3{0, 1, 0}));
    vec3 k = cross(d, h);
    for (int step = 0;; step++) {
        if (!oracle.evaluate(face, u, v, sample))
            return false;
        if (step == steps)
            return true;
        vec3 off = sample->p - origin;
        double a = dot(h, sample->du), b = dot(h, sample->dv);
        double c = dot(k, sample->du), e = dot(k, sample->dv);
        double det = a * e - b * c, f = dot(h, off), g = dot(k, off);
        double du = (e * f - b * g) / det, dv = (a * g - c * f) / det;
        if (!(std::fabs(du) + std::fabs(dv) < 0.1))
            return false;
        u -= du;
        v -= dv;
    }
}
