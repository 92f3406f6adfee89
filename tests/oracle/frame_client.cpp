#include "tests/oracle/frame_client.h"

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace
{

void check(sheen_status status, const sheen_error &error)
{
    if (status != SHEEN_OK)
        throw std::runtime_error(error.text);
}

void store(double to[3], vec3 v)
{
    to[0] = v.x;
    to[1] = v.y;
    to[2] = v.z;
}

vec3 from(const double v[3])
{
    return {v[0], v[1], v[2]};
}

sheen_camera camera_of(const view &view)
{
    sheen_camera camera = sheen_request_defaults().camera;
    if (view.chosen_by_sheen)
        return camera;
    camera.auto_view = camera.auto_up = false;
    camera.projection =
        view.orthographic ? SHEEN_PROJECTION_ORTHOGRAPHIC : SHEEN_PROJECTION_PERSPECTIVE;
    store(camera.eye, view.eye);
    store(camera.target, view.target);
    store(camera.up, view.up);
    (view.orthographic ? camera.ortho_height : camera.fov_deg) =
        view.orthographic ? view.ortho_height : view.fov_deg;
    return camera;
}

void read_chosen_camera(const sheen_camera &camera, view *view)
{
    view->eye = from(camera.eye);
    view->target = from(camera.target);
    view->up = from(camera.up);
    view->orthographic = camera.projection == SHEEN_PROJECTION_ORTHOGRAPHIC;
    view->ortho_height = camera.ortho_height;
    view->fov_deg = camera.fov_deg;
}

/* Part k of every pixel's n values of 32 bits. */
template <typename T> std::vector<T> part_of(const void *plane, size_t pixels, size_t n, size_t k)
{
    static_assert(sizeof(T) == 4, "a float or uint32_t");
    std::vector<T> part(pixels);
    const uint8_t *from = static_cast<const uint8_t *>(plane) + 4 * k;
    for (size_t i = 0; i < pixels; i++)
        std::memcpy(&part[i], from + 4 * n * i, sizeof(T));
    return part;
}

} // namespace

frame_client::frame_client(const std::string &model_path)
{
    std::ifstream file(model_path, std::ios::binary);
    std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    sheen_connect_options options = sheen_connect_defaults();
    options.address = std::getenv("SHEEN_SERVER");
    check(sheen_connect(&session, &options, &error), error);
    sheen_file_id(bytes.data(), bytes.size(), request.model_id);
    try {
        check(sheen_upload(session, SHEEN_FILE_MODEL, request.model_id, bytes.data(), bytes.size(),
                           model_path.c_str(), nullptr, &error),
              error);
    } catch (...) {
        sheen_close(session);
        throw;
    }
}

frame_client::~frame_client()
{
    sheen_frame_finish(&frame);
    sheen_close(session);
}

planes frame_client::draw(view *view)
{
    request.width_px = (uint32_t)view->width_px;
    request.height_px = (uint32_t)view->height_px;
    request.camera = camera_of(*view);
    request.planes =
        SHEEN_PLANE_POSITION | SHEEN_PLANE_NORMAL | SHEEN_PLANE_PTEX | SHEEN_PLANE_CURVATURE;
    request.format = SHEEN_FORMAT_RAW;
    check(sheen_render(session, &request, nullptr, &frame, &error), error);
    if (frame.width_px != request.width_px || frame.height_px != request.height_px)
        throw std::runtime_error("the frame has another size than asked for");
    if (view->chosen_by_sheen)
        read_chosen_camera(frame.camera, view);
    const void *position = frame.plane[1], *normal = frame.plane[2], *ptex = frame.plane[3];
    const void *curvature = frame.plane[5];
    if (!position || !normal || !ptex || !curvature)
        throw std::runtime_error("the frame lacks a plane");
    size_t pixels = (size_t)frame.width_px * frame.height_px;
    planes planes;
    planes.width_px = view->width_px;
    planes.height_px = view->height_px;
    std::vector<float> *const places[] = {&planes.px, &planes.py, &planes.pz};
    std::vector<float> *const normals[] = {&planes.nx, &planes.ny, &planes.nz};
    for (size_t k = 0; k < 3; k++) {
        *places[k] = part_of<float>(position, pixels, 3, k);
        *normals[k] = part_of<float>(normal, pixels, 3, k);
    }
    planes.face = part_of<uint32_t>(ptex, pixels, 3, 0);
    planes.u = part_of<float>(ptex, pixels, 3, 1);
    planes.v = part_of<float>(ptex, pixels, 3, 2);
    planes.k_min = part_of<float>(curvature, pixels, 2, 0);
    planes.k_max = part_of<float>(curvature, pixels, 2, 1);
    return planes;
}
