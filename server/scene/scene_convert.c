#include "server/scene/scene_convert.h"

#include <math.h>
#include <string.h>

#include "protocol/messages/message_values.h"
#include "protocol/ranges.h"
#include "server/scene/defaults.h"

_Static_assert((int)PLANE_COLOUR == (int)sheen_Plane_PLANE_COLOUR &&
                   (int)PLANE_POSITION == (int)sheen_Plane_PLANE_POSITION &&
                   (int)PLANE_NORMAL == (int)sheen_Plane_PLANE_NORMAL &&
                   (int)PLANE_PTEX == (int)sheen_Plane_PLANE_PTEX &&
                   (int)PLANE_LIGHT == (int)sheen_Plane_PLANE_LIGHT &&
                   (int)PLANE_CURVATURE == (int)sheen_Plane_PLANE_CURVATURE &&
                   (int)PLANE_LIGHT_CHANGE == (int)sheen_Plane_PLANE_LIGHT_CHANGE &&
                   (int)PLANE_COVERAGE == (int)sheen_Plane_PLANE_COVERAGE,
               "planes have the same bits on the wire");
_Static_assert((int)VIEW_AROUND == (int)sheen_View_VIEW_AROUND &&
                   (int)VIEW_ISO == (int)sheen_View_VIEW_ISO,
               "views have the same numbers on the wire");
_Static_assert((int)SURFACE_EXACT == (int)sheen_SurfaceKind_SURFACE_EXACT &&
                   (int)SURFACE_POLYGON == (int)sheen_SurfaceKind_SURFACE_POLYGON &&
                   (int)SURFACE_WIREFRAME == (int)sheen_SurfaceKind_SURFACE_WIREFRAME,
               "surfaces have the same numbers on the wire");
/* Colours that a request leaves out. Where the reflected ray misses the light, the colour differs
 * from a dark stripe. */
static const sheen_Colour DEFAULT_MISS = {0.16f, 0.19f, 0.23f, 1};
static const sheen_Colour DEFAULT_EMPTY = {0.5f, 0.5f, 0.5f, 1};
static const sheen_Colour DEFAULT_BASE = {0.7f, 0.72f, 0.75f, 1};

/* Applies the camera of a request to the camera that frames the model. */
static void to_camera(const sheen_Camera *from, const struct scene_subject *subject,
                      const double up[3], struct camera *to)
{
    if (from->has_eye)
        message_read_vec3(&from->eye, to->eye);
    if (from->has_target)
        message_read_vec3(&from->target, to->target);
    if (from->has_target && !(from->has_eye && from->has_up))
        scene_default_roll(up, to);
    if (from->has_fov_deg)
        to->fov_deg = from->fov_deg;
    if (!from->has_ortho_height)
        return;
    to->kind = CAMERA_ORTHOGRAPHIC;
    to->ortho_height = from->ortho_height;
    if (from->has_eye)
        return;
    /* The height need not fit the model: stand outside of the box, in whatever direction. */
    double diagonal = 0, distance = 0;
    for (int i = 0; i < 3; i++) {
        diagonal = hypot(diagonal, subject->tables->box_max[i] - subject->tables->box_min[i]);
        distance = hypot(distance, to->eye[i] - to->target[i]);
    }
    for (int i = 0; i < 3; i++)
        to->eye[i] += (to->eye[i] - to->target[i]) * (diagonal / distance);
}

sheen_Camera scene_write_camera(const struct camera *camera)
{
    bool ortho = camera->kind == CAMERA_ORTHOGRAPHIC;
    return (sheen_Camera){
        .has_eye = true,
        .eye = message_vec3(camera->eye),
        .has_target = true,
        .target = message_vec3(camera->target),
        .has_up = true,
        .up = message_vec3(camera->up),
        .has_fov_deg = !ortho,
        .fov_deg = camera->fov_deg,
        .has_ortho_height = ortho,
        .ortho_height = camera->ortho_height,
    };
}

sheen_UpSource scene_model_up(const sheen_Render *render, const struct scene_subject *subject,
                              double up[3])
{
    if (render->has_camera && render->camera.has_up) {
        message_read_vec3(&render->camera.up, up);
        return sheen_UpSource_UP_GIVEN;
    }
    if (subject->up == CAGE_UP_UNSAID) {
        scene_guess_up(subject->tables->box_min, subject->tables->box_max, up);
        return sheen_UpSource_UP_GUESSED;
    }
    up[0] = subject->up == CAGE_UP_X;
    up[1] = subject->up == CAGE_UP_Y;
    up[2] = subject->up == CAGE_UP_Z;
    return sheen_UpSource_UP_FILE;
}

void scene_read_request(const sheen_Render *render, const struct scene_subject *subject,
                        struct frame_request *request)
{
    static const sheen_Light default_light = sheen_Light_init_default;
    static const sheen_Camera default_camera = sheen_Camera_init_default;
    const sheen_Camera *asked = render->has_camera ? &render->camera : &default_camera;
    *request = (struct frame_request){
        .width_px = render->width_px,
        .height_px = render->height_px,
        .planes = message_render_planes(render),
        .unfiltered = render->unfiltered,
        .aliased = render->aliased,
        .n_lights = render->lights_count ? render->lights_count : 1,
        .surface = {(enum surface_kind)render->surface, render->surface_level},
    };
    double up[3], diagonal[3];
    for (int i = 0; i < 3; i++)
        diagonal[i] = subject->tables->box_max[i] - subject->tables->box_min[i];
    request->model_size = range_length(diagonal);
    request->has_chosen_camera = !asked->has_eye;
    /* A window leaves the camera of the picture as it is. */
    const sheen_Window *window = &render->window;
    uint32_t width_px = render->has_window ? window->width_px : render->width_px;
    uint32_t height_px = render->has_window ? window->height_px : render->height_px;
    scene_model_up(render, subject, up);
    scene_default_camera(subject->tables, up, (enum default_view)asked->view, width_px, height_px,
                         &request->camera);
    to_camera(asked, subject, up, &request->camera);
    if (asked->has_zoom)
        scene_zoom(&request->camera, width_px, height_px, asked->zoom, asked->zoom_x,
                   asked->zoom_y);
    if (render->has_window)
        request->camera.window =
            (struct camera_window){window->x_px, window->y_px, window->width_px, window->height_px};
    scene_read_lines(&render->lines, up, &request->lines);
    for (uint32_t i = 0; i < request->n_lights; i++)
        scene_read_light(render->lights_count ? &render->lights[i] : &default_light, subject, up,
                         &request->lights[i]);
    message_read_colour(render->has_miss ? &render->miss : &DEFAULT_MISS, request->miss);
    message_read_colour(render->has_empty ? &render->empty : &DEFAULT_EMPTY, request->empty);
    message_read_colour(render->has_base ? &render->base : &DEFAULT_BASE, request->base);
}
