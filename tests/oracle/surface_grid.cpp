#include "tests/oracle/surface_grid.h"

#include "tests/oracle/cage_file.h"
#include "tests/oracle/look_from.h"
#include "tests/oracle/scene.h"

struct grid_model::parts {
    scene shown;
    drawing device;

    explicit parts(const std::string &path) : shown(read_cage_file(path)), device(shown)
    {
    }
};

grid_model::grid_model(const std::string &file) : path(file), own(std::make_unique<parts>(file))
{
    const double *low = own->shown.tables.box_min, *high = own->shown.tables.box_max;
    box_min = {low[0], low[1], low[2]};
    box_max = {high[0], high[1], high[2]};
}

grid_model::~grid_model() = default;

surface_grid grid_model::sample(const view &view, int side)
{
    frame_request request =
        own->shown.request((uint32_t)(view.width_px * side), (uint32_t)(view.height_px * side));
    look_from(view, &request);
    request.unfiltered = true;
    request.planes = PLANE_POSITION | PLANE_NORMAL;
    frame frame = own->device.render(request);
    surface_grid grid;
    grid.width = frame.width_px;
    grid.height = frame.height_px;
    auto *positions = static_cast<const std::array<float, 3> *>(frame.plane[1]);
    auto *normals = static_cast<const std::array<float, 3> *>(frame.plane[2]);
    grid.positions.assign(positions, positions + grid.width * grid.height);
    grid.normals.assign(normals, normals + grid.width * grid.height);
    frame_finish(&frame);
    return grid;
}
