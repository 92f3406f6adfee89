/* The reference picture: libosd's surface cut into cells of two pixels or less and rasterised on
 * the CPU in double, 3 x 3 samples a pixel, the middle one at the pixel's centre. */
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
        double depth;  /* along the view direction, world units; infinite where nothing is hit */
        uint32_t face; /* Ptex face of the nearest surface, no_face where none */
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

/* Surface behind the eye's plane is left out; all else is drawn, from both sides. */
raster rasterize(const osd_oracle &oracle, const view &view);

#endif
