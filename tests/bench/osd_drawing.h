/* The peer on a GPU: OpenSubdiv's patch table drawn as its examples do, with its own GLSL
 * tessellation shaders, on the context that is current. The stripes by its own normal, interpolated
 * over its triangles; one sample a pixel. */
#ifndef SHEEN_TESTS_BENCH_OSD_DRAWING_H
#define SHEEN_TESTS_BENCH_OSD_DRAWING_H

#include <memory>
#include <string>
#include <vector>

extern "C" {
#include "server/cage/cage.h"
}
#include "tests/oracle/renderer.h"

class osd_drawing
{
  public:
    /* Features isolated to `level`; triangle edges about so many pixels long; `software`: the
     * device is llvmpipe. Throws std::runtime_error when the device refuses its shaders. */
    osd_drawing(const cage &cage, int level, double edge_px, bool software);
    ~osd_drawing();
    osd_drawing(const osd_drawing &) = delete;
    osd_drawing &operator=(const osd_drawing &) = delete;

    /* Draws for a perspective camera and one rectangle light with stripes by count, and waits for
     * the device. `by_device`: returns the device's own milliseconds, else the clock's. */
    double draw_ms(const frame_request &request, bool by_device);
    /* World normals of the same picture, 3 floats a pixel, NaN where nothing is hit; rows top
     * first.
     */
    std::vector<float> normals(const frame_request &request);
    /* "OpenSubdiv 3.5.0" */
    static std::string version();

  private:
    struct implementation;
    std::unique_ptr<implementation> m;
};

#endif
