#include "server/gpu/view.h"

#include <math.h>

#include "server/limit/vec.h"

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

/* Depths of the box's corners. Near stays positive for perspective: single precision depth is
 * relative (near / z), so a small near costs nothing. */
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
    double height = view->perspective ? 2 * tan(camera->fov_deg * (3.14159265358979323846 / 360))
                                      : camera->ortho_height;
    view->units_per_px = height / height_px;
    view->centre_px[0] = 0.5 * width_px;
    view->centre_px[1] = 0.5 * height_px;
    view->width_px = width_px;
    view->height_px = height_px;
    set_depths(view, box_min, box_max);
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
    /* Reversed: 1 at near, 0 at far or infinity. */
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
