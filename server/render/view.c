#include "server/render/view.h"

#include <math.h>

#include "server/surface/vec.h"

static struct vec from_array(const double a[3])
{
    return (struct vec){a[0], a[1], a[2]};
}

static void to_array(struct vec v, double a[3])
{
    a[0] = v.x;
    a[1] = v.y;
    a[2] = v.z;
}

/* Sets near and far by the box's corners. Near is positive for perspective: depth in single
 * precision is relative (near / z), so a small near costs nothing. */
static void set_depths(struct view *view, const double box_min[3], const double box_max[3])
{
    double nearest = INFINITY, farthest = -INFINITY, diagonal = 0;
    for (int k = 0; k < 3; k++)
        diagonal = hypot(diagonal, box_max[k] - box_min[k]);
    for (int i = 0; i < 8; i++) {
        double corner[3], camera[3];
        for (int k = 0; k < 3; k++)
            corner[k] = i >> k & 1 ? box_max[k] : box_min[k];
        view_transform(view, corner, camera);
        nearest = fmin(nearest, camera[2]);
        farthest = fmax(farthest, camera[2]);
    }
    double margin = 1e-3 * diagonal + 1e-12 * fabs(farthest);
    double least = view->perspective ? 1e-10 * (diagonal + fabs(farthest)) : 0;
    view->near = fmax(nearest - margin, least);
    view->far = fmax(farthest + margin, view->near + margin + least);
}

void view_init(struct view *view, const struct camera *camera, uint32_t width_px,
               uint32_t height_px, const double box_min[3], const double box_max[3])
{
    struct vec eye = from_array(camera->eye), target = from_array(camera->target);
    struct vec forward = vec_unit(vec_sub(target, eye));
    struct vec right = vec_unit(vec_cross(forward, vec_unit(from_array(camera->up))));
    to_array(eye, view->eye);
    to_array(right, view->axis[0]);
    to_array(vec_cross(forward, right), view->axis[1]);
    to_array(forward, view->axis[2]);
    view->perspective = camera->kind == CAMERA_PERSPECTIVE;
    const struct camera_window *window = &camera->window;
    bool is_part = window->width_px > 0;
    uint32_t whole_width_px = is_part ? window->width_px : width_px;
    uint32_t whole_height_px = is_part ? window->height_px : height_px;
    /* Whole pixels of the place are the tiles' (view_part_of()). */
    double shift_x = window->x - floor(window->x), shift_y = window->y - floor(window->y);
    double height = view->perspective ? 2 * tan(camera->fov_deg * (3.14159265358979323846 / 360))
                                      : camera->ortho_height;
    view->units_per_px = height / whole_height_px;
    view->centre_px[0] = 0.5 * whole_width_px - shift_x;
    view->centre_px[1] = 0.5 * whole_height_px - shift_y;
    view->width_px = whole_width_px;
    view->height_px = whole_height_px;
    set_depths(view, box_min, box_max);
}

struct view_part view_part_of(const struct frame_request *request)
{
    const struct camera_window *window = &request->camera.window;
    if (window->width_px == 0)
        return (struct view_part){.picture = {request->width_px, request->height_px}};
    return (struct view_part){.x = (uint32_t)window->x,
                              .y = (uint32_t)window->y,
                              .picture = {window->width_px, window->height_px}};
}

struct tile view_tile(const struct view_part *part, const struct tile *tile)
{
    return (struct tile){tile->x + part->x, tile->y + part->y, tile->width, tile->height};
}

void view_block_fill(struct view_block *block, const struct view *view, const struct tile *tile)
{
    *block = (struct view_block){0};
    for (int k = 0; k < 3; k++) {
        block->eye[k] = view->eye[k];
        for (int a = 0; a < 3; a++)
            block->axis[a][k] = (float)view->axis[a][k];
    }
    block->ray[view->perspective ? 0 : 1] = (float)view->units_per_px;
    block->ray[2] = (float)view->centre_px[0];
    block->ray[3] = (float)view->centre_px[1];
    const double origin[2] = {tile->x, tile->y}, size[2] = {tile->width, tile->height};
    for (int k = 0; k < 2; k++) {
        block->clip[k] = (float)(2 / (size[k] * view->units_per_px));
        block->clip[2 + k] = (float)((view->centre_px[k] - origin[k]) * 2 / size[k] - 1);
    }
    /* Reversed depth: 1 at near, 0 at far or infinity. */
    double range = view->far - view->near;
    block->depth[0] = (float)view->near;
    block->depth[1] = (float)(view->far / range);
    block->depth[2] = (float)(-1 / range);
    block->tile[0] = (int32_t)tile->x;
    block->tile[1] = (int32_t)tile->y;
    block->tile[2] = (int32_t)tile->width;
    block->tile[3] = (int32_t)tile->height;
}

void view_transform(const struct view *view, const double world[3], double camera[3])
{
    double d[3];
    for (int k = 0; k < 3; k++)
        d[k] = world[k] - view->eye[k];
    for (int a = 0; a < 3; a++)
        camera[a] = view->axis[a][0] * d[0] + view->axis[a][1] * d[1] + view->axis[a][2] * d[2];
}

void view_position(const struct view *view, uint32_t x, uint32_t y, double z, float world[3])
{
    double px = view->units_per_px * (view->perspective ? z : 1);
    double right = (x + 0.5 - view->centre_px[0]) * px;
    double down = (y + 0.5 - view->centre_px[1]) * px;
    for (int k = 0; k < 3; k++)
        world[k] = (float)(view->eye[k] + right * view->axis[0][k] + down * view->axis[1][k] +
                           z * view->axis[2][k]);
}

void view_sides_init(struct view_sides *sides, const struct view *view, const struct tile *tile)
{
    const double low[2] = {tile->x, tile->y};
    const double high[2] = {(double)tile->x + tile->width, (double)tile->y + tile->height};
    sides->near = view->near;
    for (int k = 0; k < 2; k++) {
        double a = (low[k] - view->centre_px[k]) * view->units_per_px;
        double b = (high[k] - view->centre_px[k]) * view->units_per_px;
        double *first = sides->side[2 * k], *second = sides->side[2 * k + 1];
        for (int i = 0; i < 3; i++)
            first[i] = second[i] = 0;
        double la = view->perspective ? hypot(1, a) : 1, lb = view->perspective ? hypot(1, b) : 1;
        first[k] = 1 / la;
        second[k] = -1 / lb;
        first[2] = view->perspective ? -a / la : 0;
        second[2] = view->perspective ? b / lb : 0;
        sides->offset[2 * k] = view->perspective ? 0 : -a;
        sides->offset[2 * k + 1] = view->perspective ? 0 : b;
    }
}

bool view_sides_exclude(const struct view_sides *sides, const double centre[3], double radius)
{
    if (centre[2] + radius < sides->near)
        return true;
    for (int s = 0; s < 4; s++) {
        const double *side = sides->side[s];
        double distance = side[0] * centre[0] + side[1] * centre[1] + side[2] * centre[2];
        if (distance + sides->offset[s] < -radius)
            return true;
    }
    return false;
}
