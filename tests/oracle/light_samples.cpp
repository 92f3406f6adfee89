#include "tests/oracle/light_samples.h"

#include <cmath>

static void fill(float colour[4], float value)
{
    for (int k = 0; k < 4; k++)
        colour[k] = k < 3 ? value : 1;
}

/* A white light; black where rays miss the light, grey where they miss the model. */
static frame_request enlarged(frame_request request, const middle_part &part)
{
    const double deg = M_PI / 180;
    camera &camera = request.camera;
    double share = (double)part.height_px / request.height_px;
    camera.fov_deg = 2 * std::atan(std::tan(camera.fov_deg / 2 * deg) * share) / deg;
    request.width_px = (uint32_t)(part.width_px * light_samples::side);
    request.height_px = (uint32_t)(part.height_px * light_samples::side);
    request.unfiltered = true;
    request.planes = PLANE_COLOUR | PLANE_LIGHT;
    fill(request.lights[0].pattern.foreground, 1);
    fill(request.lights[0].pattern.background, 1);
    fill(request.miss, 0);
    fill(request.empty, 0.5f);
    return request;
}

/* For each pixel, the number of its samples for which is_so(index of the sample) holds. */
template <typename predicate>
void light_samples::count(std::vector<uint16_t> *n, predicate is_so) const
{
    n->assign((size_t)width_px * (size_t)height_px, 0);
    size_t sample = 0;
    for (int row = 0; row < height_px * side; row++)
        for (int x = 0; x < width_px; x++) {
            unsigned found = 0;
            for (int k = 0; k < side; k++)
                found += is_so(sample++);
            uint16_t &sum = (*n)[(size_t)(row / side) * (size_t)width_px + (size_t)x];
            sum = (uint16_t)(sum + found);
        }
}

light_samples::light_samples(drawing *drawing, const frame_request &request,
                             const middle_part &part)
    : width_px(part.width_px), height_px(part.height_px)
{
    frame = drawing->render(enlarged(request, part));
    auto *colour = static_cast<const uint8_t(*)[4]>(frame.plane[0]);
    count(&n_miss, [&](size_t i) { return colour[i][0] == 0; });
    count(&n_empty, [&](size_t i) { return colour[i][0] != 0 && colour[i][0] != 255; });
}

light_samples::~light_samples()
{
    frame_finish(&frame);
}

std::vector<uint16_t> light_samples::bright(double stripes) const
{
    std::vector<uint16_t> n;
    auto *st = static_cast<const float(*)[2]>(frame.plane[4]);
    count(&n, [&](size_t i) {
        double phase = st[i][0] * stripes; /* comparisons with NaN are false */
        return phase - std::floor(phase) < 0.5;
    });
    return n;
}
