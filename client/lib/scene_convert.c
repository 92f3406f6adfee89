#include "client/lib/scene_convert.h"

#include <math.h>
#include <string.h>

#include "protocol/messages/message_values.h"

_Static_assert((int)SHEEN_PATTERN_IMAGE == (int)sheen_PatternKind_PATTERN_IMAGE, "same order");
_Static_assert((int)SHEEN_PATTERN_DISTANCE == (int)sheen_PatternKind_PATTERN_DISTANCE,
               "same order");
_Static_assert((int)SHEEN_LIGHT_SPHERE == (int)sheen_LightKind_LIGHT_SPHERE, "same order");
_Static_assert((int)SHEEN_LINES_ENVIRONMENT == (int)sheen_LineFamily_LINES_ENVIRONMENT,
               "same order");
_Static_assert((int)SHEEN_SHOW_DRAFT == (int)sheen_ShowKind_SHOW_DRAFT, "same order");
_Static_assert((int)SHEEN_VIEW_ISO == (int)sheen_View_VIEW_ISO, "same order");
_Static_assert((int)SHEEN_CLASS_BATCH == (int)sheen_RequestClass_CLASS_BATCH, "same order");
_Static_assert((int)SHEEN_FORMAT_TIFF == (int)sheen_Encoding_ENCODING_TIFF, "same order");
_Static_assert((int)SHEEN_JPEG_420 == (int)sheen_JpegSubsampling_JPEG_420, "same order");
_Static_assert((int)SHEEN_PLANE_COVERAGE == (int)sheen_Plane_PLANE_COVERAGE, "same bits");
_Static_assert(SHEEN_MAX_LIGHTS == sizeof((sheen_Render *)0)->lights / sizeof(sheen_Light),
               "as many as the wire carries");
_Static_assert(SHEEN_MAX_LINES == sizeof((sheen_Pattern *)0)->at / sizeof(double),
               "as many as the wire carries");

static sheen_Pattern to_pattern(const struct sheen_pattern *pattern)
{
    bool is_lines = pattern->kind == SHEEN_PATTERN_LINES;
    sheen_Pattern message = {
        .kind = (sheen_PatternKind)pattern->kind,
        MESSAGE_PATTERN_NUMBERS(pattern),
        .has_width = is_lines,
        .has_foreground = pattern->has_colours,
        .foreground = message_colour(pattern->foreground),
        .has_background = pattern->has_colours,
        .background = message_colour(pattern->background),
        .has_image_sha256 = pattern->kind == SHEEN_PATTERN_IMAGE,
    };
    memcpy(message.image_sha256, pattern->image_id, SHEEN_ID_BYTES);
    for (; is_lines && message.at_count < pattern->n_at && message.at_count < SHEEN_MAX_LINES;
         message.at_count++)
        message.at[message.at_count] = pattern->at[message.at_count];
    return message;
}

static sheen_Light to_light(const struct sheen_light *light)
{
    return (sheen_Light){
        .has_kind = light->has_kind || light->is_placed,
        .kind = (sheen_LightKind)light->kind,
        .has_one_sided = true,
        .one_sided = light->one_sided,
        .has_centre = light->is_placed,
        .centre = message_vec3(light->centre),
        .has_u = light->is_placed,
        .u = message_vec3(light->u),
        .has_v = light->is_placed,
        .v = message_vec3(light->v),
        .has_pattern = true,
        .pattern = to_pattern(&light->pattern),
    };
}

static void fill_lights(sheen_Render *render, const struct sheen_request *request)
{
    const struct sheen_lines *lines = &request->lines;
    render->has_lines = true;
    render->lines = (sheen_Lines){
        .family = (sheen_LineFamily)lines->family,
        .has_direction = lines->has_direction,
        .direction = message_vec3(lines->direction),
        .has_eye = lines->eye_kind == SHEEN_LINE_EYE_POINT,
        .eye = message_vec3(lines->eye),
        .has_eye_direction = lines->eye_kind == SHEEN_LINE_EYE_DIRECTION,
        .eye_direction = message_vec3(lines->eye),
    };
    for (uint32_t i = 0; i < request->n_lights; i++)
        render->lights[i] = to_light(&request->lights[i]);
    render->lights_count = (pb_size_t)request->n_lights;
    render->has_show = request->show.kind != SHEEN_SHOW_LINES || request->show.range != 0;
    render->show = (sheen_Show){
        .kind = (sheen_ShowKind)request->show.kind,
        .has_direction = request->show.kind == SHEEN_SHOW_DRAFT,
        .direction = message_vec3(request->show.direction),
        .has_range = request->show.range != 0,
        .range = request->show.range,
        .has_legend = request->show.without_legend,
        .legend = !request->show.without_legend,
    };
}

static void fill_camera(sheen_Render *render, const struct sheen_camera *camera)
{
    if (camera->projection == SHEEN_PROJECTION_AUTO)
        return;
    bool ortho = camera->projection == SHEEN_PROJECTION_ORTHOGRAPHIC;
    render->has_camera = true;
    render->camera = (sheen_Camera){
        .has_eye = !camera->auto_view,
        .eye = message_vec3(camera->eye),
        .has_target = !camera->auto_view || camera->has_target,
        .target = message_vec3(camera->target),
        .has_up = !camera->auto_up,
        .up = message_vec3(camera->up),
        .has_fov_deg = !ortho,
        .fov_deg = camera->fov_deg,
        .has_ortho_height = ortho,
        .ortho_height = camera->ortho_height,
        .has_view = camera->auto_view && camera->view != SHEEN_VIEW_AROUND,
        .view = (sheen_View)camera->view,
        .has_zoom = camera->zoom > 0,
        .zoom = camera->zoom,
        .has_zoom_x = camera->zoom > 0,
        .zoom_x = camera->zoom_at[0],
        .has_zoom_y = camera->zoom > 0,
        .zoom_y = camera->zoom_at[1],
    };
}

void scene_to_message(sheen_Render *render, const struct sheen_request *request)
{
    *render = (sheen_Render){
        .width_px = request->width_px,
        .height_px = request->height_px,
        .has_miss = request->has_miss,
        .miss = message_colour(request->miss),
        .has_empty = request->has_empty,
        .empty = message_colour(request->empty),
        .has_base = request->has_base,
        .base = message_colour(request->base),
        .has_unfiltered = request->unfiltered,
        .unfiltered = request->unfiltered,
        .has_aliased = request->aliased,
        .aliased = request->aliased,
        .planes = request->planes,
        .encoding = (sheen_Encoding)request->format,
        .has_jpeg_quality = request->jpeg_quality != 0,
        .jpeg_quality = request->jpeg_quality,
        .has_jpeg_subsampling = request->jpeg_subsampling != SHEEN_JPEG_444,
        .jpeg_subsampling = (sheen_JpegSubsampling)request->jpeg_subsampling,
        .has_surface = request->surface != SHEEN_SURFACE_EXACT,
        .surface = (sheen_SurfaceKind)request->surface,
        .has_surface_level = request->surface_level != 0,
        .surface_level = request->surface_level,
        .has_request_class = request->request_class != SHEEN_CLASS_STILL,
        .request_class = (sheen_RequestClass)request->request_class,
        .has_view = request->has_view,
        .view = request->view,
        .has_deadline_ms = request->deadline_ms != 0,
        .deadline_ms = request->deadline_ms,
        .has_window = request->window.width_px != 0 || request->window.height_px != 0,
        .window = {request->window.x_px, request->window.y_px, request->window.width_px,
                   request->window.height_px},
    };
    memcpy(render->model_sha256, request->model_id, SHEEN_ID_BYTES);
    fill_camera(render, &request->camera);
    fill_lights(render, request);
}

static void from_pattern(struct sheen_pattern *pattern, const sheen_Pattern *message)
{
    *pattern = (struct sheen_pattern){
        .kind = (enum sheen_pattern_kind)message->kind,
        MESSAGE_PATTERN_NUMBERS_OF(message),
        .has_colours = true,
    };
    memcpy(pattern->at, message->at, sizeof(pattern->at));
    memcpy(pattern->image_id, message->image_sha256, SHEEN_ID_BYTES);
    message_read_colour(&message->foreground, pattern->foreground);
    message_read_colour(&message->background, pattern->background);
}

static void get_extreme(struct sheen_extreme *extreme, bool has_value, const sheen_Extreme *message)
{
    *extreme = (struct sheen_extreme){
        .has_value = has_value,
        .value = message->value,
        .has_place = message->has_position,
        .x_px = message->x_px,
        .y_px = message->y_px,
        .has_ptex = message->has_face,
        .face = message->face,
        .u = message->u,
        .v = message->v,
    };
    message_read_vec3(&message->position, extreme->position);
}

void scene_lines_from_message(struct sheen_lines *to, const sheen_Lines *lines)
{
    *to = (struct sheen_lines){
        .family = (enum sheen_line_family)lines->family,
        .has_direction = lines->has_direction,
        .eye_kind = lines->has_eye             ? SHEEN_LINE_EYE_POINT
                    : lines->has_eye_direction ? SHEEN_LINE_EYE_DIRECTION
                                               : SHEEN_LINE_EYE_CAMERA,
    };
    message_read_vec3(&lines->direction, to->direction);
    message_read_vec3(lines->has_eye ? &lines->eye : &lines->eye_direction, to->eye);
}

void scene_light_from_message(struct sheen_light *to, const sheen_Light *from)
{
    *to = (struct sheen_light){.kind = (enum sheen_light_kind)from->kind,
                               .has_kind = true,
                               .is_placed = true,
                               .one_sided = from->one_sided};
    message_read_vec3(&from->centre, to->centre);
    message_read_vec3(&from->u, to->u);
    message_read_vec3(&from->v, to->v);
    from_pattern(&to->pattern, &from->pattern);
}

void scene_camera_from_message(struct sheen_camera *to, const sheen_Camera *camera)
{
    *to = (struct sheen_camera){
        .projection =
            camera->has_ortho_height ? SHEEN_PROJECTION_ORTHOGRAPHIC : SHEEN_PROJECTION_PERSPECTIVE,
        .fov_deg = camera->fov_deg,
        .ortho_height = camera->ortho_height,
    };
    message_read_vec3(&camera->eye, to->eye);
    message_read_vec3(&camera->target, to->target);
    message_read_vec3(&camera->up, to->up);
}

static void get_lights(struct sheen_frame *frame, const sheen_Frame *body)
{
    scene_lines_from_message(&frame->lines, &body->lines);
    frame->show_range = body->has_show_range ? body->show_range : 0;
    get_extreme(&frame->show_least, body->has_show_least, &body->show_least);
    get_extreme(&frame->show_greatest, body->has_show_greatest, &body->show_greatest);
    frame->has_colours = body->has_miss && body->has_empty && body->has_base;
    message_read_colour(&body->miss, frame->miss);
    message_read_colour(&body->empty, frame->empty);
    message_read_colour(&body->base, frame->base);
    frame->n_lights = body->lights_count;
    for (uint32_t i = 0; i < frame->n_lights; i++)
        scene_light_from_message(&frame->lights[i], &body->lights[i]);
}

void scene_from_message(struct sheen_frame *frame, const sheen_Frame *body)
{
    scene_camera_from_message(&frame->camera, &body->camera);
    message_read_vec3(&body->up, frame->up);
    frame->up_source = body->has_up && body->has_up_source ? (enum sheen_up_source)body->up_source
                                                           : SHEEN_UP_UNKNOWN;
    frame->blank = body->blank;
    frame->light_share = body->has_light_share ? body->light_share : NAN;
    get_lights(frame, body);
}
