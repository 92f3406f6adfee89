/* The reference picture: libosd's surface cut into cells of at most two pixels and rasterised on
 * the CPU in double precision, with 3 x 3 samples for each pixel, the middle one at its centre. */
#ifndef SHEEN_TESTS_ORACLE_RASTER_H
#define SHEEN_TESTS_ORACLE_RASTER_H

#include <cstdint>
#include <vector>

#include "tests/oracle/osd_oracle.h"
#include "tests/oracle/view.h"

const int raster_factor = 3;

struct raster {
    int width = 0, height = 0; /* samples: raster_factor times the pixels */
    struct sample {
        double depth;  /* along the view direction, world units; infinite without a surface */
        uint32_t face; /* Ptex face of the nearest surface; no_face without one */
        float u, v;
    };
    std::vector<sample> samples; /* rows top first */

    const sample &at(int x, int y) const
    {
        return samples[(size_t)y * (size_t)width + (size_t)x];
    }
    const sample &centre(int x_px, int y_px) const
    {
        return at(raster_factor * x_px + 1, raster_factor * y_px + 1);
    }
};

/* Draws everything, from both sides, except surface behind the plane of the eye. */
raster rasterize(const osd_oracle &oracle, const view &view);

#endif
