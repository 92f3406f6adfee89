/* The peer on a GPU: draws OpenSubdiv's patch table like its examples, with its own GLSL
 * tessellation shaders, in the current context. Stripes use its own normal, interpolated over its
 * triangles; one sample for each pixel. */
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
    /* Isolates features to `level`; triangle edges are about edge_px long; `software`: the device
     * is llvmpipe. Throws std::runtime_error if the device refuses its shaders. */
    osd_drawing(const cage &cage, int level, double edge_px, bool software);
    ~osd_drawing();
    osd_drawing(const osd_drawing &) = delete;
    osd_drawing &operator=(const osd_drawing &) = delete;

    /* Draws for a perspective camera and one rectangle light with stripes by count, and waits for
     * the device. Returns the device's own milliseconds if by_device, else elapsed ones. */
    double draw_ms(const frame_request &request, bool by_device);
    /* The world normals of the same picture: 3 floats for each pixel, top row first; NaN without a
     * hit. */
    std::vector<float> normals(const frame_request &request);
    /* "OpenSubdiv 3.5.0" */
    static std::string version();

  private:
    struct implementation;
    std::unique_ptr<implementation> m;
};

#endif
