/* Finds the surface point that a pixel's ray meets, by Newton's method on libosd's surface in
 * double precision. */
#ifndef SHEEN_TESTS_ORACLE_SOLVE_H
#define SHEEN_TESTS_ORACLE_SOLVE_H

#include "tests/oracle/osd_oracle.h"
#include "tests/oracle/view.h"

/* Makes `steps` steps from (u, v). False if a step leaves the Ptex face or diverges. */
bool solve_ray(const osd_oracle &oracle, const projector &camera, double x, double y, int steps,
               uint32_t face, double u, double v, osd_sample *sample);

#endif
