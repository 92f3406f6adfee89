/* The checks of message.h, for rules that the schema cannot express. */
#include "protocol/message.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "protocol/codec.h"
#include "protocol/message_check.h"
#include "protocol/ranges.h"
#include "protocol/text.h"

bool check_refuse(char *text, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, MESSAGE_TEXT_BYTES, format, arguments);
    va_end(arguments);
    return false;
}

bool message_is_text(const char *text, bool lines)
{
    const unsigned char *c = (const unsigned char *)text;
    while (*c) {
        if ((*c < 0x20 && !(lines && *c == '\n')) || *c == 0x7f)
            return false;
        size_t n = text_utf8_length((const char *)c);
        if (n == 0)
            return false;
        c += n;
    }
    return true;
}

void message_make_text(char *text, bool lines)
{
    if (!message_is_text(text, lines))
        for (char *c = text; *c; c++)
            if ((*c < 0x20 && !(lines && *c == '\n')) || *c > 0x7e)
                *c = '?';
    char *to = text;
    for (const char *from = text; *from;) {
        size_t unseen = text_unseen_length(from);
        *to++ = unseen ? '?' : *from;
        from += unseen ? unseen : 1;
    }
    *to = 0;
}

bool check_text(const char *value, const char *field, char *text)
{
    return message_is_text(value, false) ||
           check_refuse(text, "%s is not UTF-8 text without control characters", field);
}

/* Writes, for example: "deadline_ms (--deadline) is 0; it must be from 1 to 3600000
 * milliseconds". */
static bool check_named(double value, const struct range *range, const char *field, char *text)
{
    char wanted[RANGE_TEXT_BYTES];
    const char *option = range->option;
    return range_holds(range, value) ||
           check_refuse(text, "%s%s%s%s is %.9g; it must be %s", field, option ? " (" : "",
                        option ? option : "", option ? ")" : "", value, range_text(range, wanted));
}

bool check_number(double value, enum range_name name, char *text)
{
    return check_named(value, &RANGES[name], RANGES[name].field, text);
}

static bool check_vec3(const sheen_Vec3 *v, const char *field, char *text)
{
    const double value[3] = {v->x, v->y, v->z};
    char name[64];
    for (int i = 0; i < 3; i++) {
        snprintf(name, sizeof name, "%s.%c", field, "xyz"[i]);
        if (!check_named(value[i], &RANGES[RANGE_COORDINATE], name, text))
            return false;
    }
    return true;
}

static bool check_enum(unsigned value, unsigned last, const char *field, char *text)
{
    return value <= last ||
           check_refuse(text, "%s is %u; it must be from 0 to %u", field, value, last);
}

static bool check_colour(const sheen_Colour *colour, const char *field, char *text)
{
    const float value[4] = {colour->r, colour->g, colour->b, colour->a};
    char name[64];
    for (int i = 0; i < 4; i++) {
        snprintf(name, sizeof name, "%s.%c", field, "rgba"[i]);
        if (!check_named((double)value[i], &RANGES[RANGE_COLOUR], name, text))
            return false;
    }
    return true;
}

/* Checks the colours that are present. */
static bool check_colours(const sheen_Colour *miss, const sheen_Colour *empty,
                          const sheen_Colour *base, char *text)
{
    return (!miss || check_colour(miss, "miss", text)) &&
           (!empty || check_colour(empty, "empty", text)) &&
           (!base || check_colour(base, "base", text));
}

static bool is_zero(const sheen_Vec3 *v)
{
    const double value[3] = {v->x, v->y, v->z};
    return range_is_zero(value);
}

static bool is_parallel(const sheen_Vec3 *a, const sheen_Vec3 *b)
{
    const double p[3] = {a->x, a->y, a->z}, q[3] = {b->x, b->y, b->z};
    return range_is_parallel(p, q);
}

/* Checks eye, target and up, as far as they are present. */
static bool check_view(const sheen_Camera *camera, char *text)
{
    if ((camera->has_eye && !check_vec3(&camera->eye, "camera.eye", text)) ||
        (camera->has_target && !check_vec3(&camera->target, "camera.target", text)) ||
        (camera->has_up && !check_vec3(&camera->up, "camera.up", text)))
        return false;
    if (camera->has_eye && !camera->has_target)
        return check_refuse(text, "camera.eye comes with camera.target");
    if (camera->has_eye && camera->has_view && camera->view != sheen_View_VIEW_AROUND)
        return check_refuse(
            text, "camera.view is of a camera that frames the model: not with camera.eye");
    const sheen_Vec3 view = {camera->target.x - camera->eye.x, camera->target.y - camera->eye.y,
                             camera->target.z - camera->eye.z};
    if (camera->has_eye && is_zero(&view))
        return check_refuse(text,
                            "camera.eye and camera.target (--eye, --target) are the same point");
    static const sheen_Vec3 y_axis = {0, 1, 0};
    if (camera->has_up &&
        (is_zero(&camera->up) || (camera->has_eye && is_parallel(&view, &camera->up))))
        return check_refuse(
            text,
            "camera.up (--up) is zero or along the line of sight: give another, as --up "
            "%s",
            is_parallel(&view, &y_axis) ? "0,0,1" : "0,1,0");
    return true;
}

static bool check_camera(const sheen_Camera *camera, char *text)
{
    if (!check_view(camera, text))
        return false;
    if (camera->has_fov_deg && camera->has_ortho_height)
        return check_refuse(text, "camera.fov_deg and camera.ortho_height exclude each other");
    return (!camera->has_ortho_height ||
            check_number(camera->ortho_height, RANGE_ORTHO_HEIGHT, text)) &&
           (!camera->has_fov_deg || check_number(camera->fov_deg, RANGE_FOV, text)) &&
           check_enum(camera->view, sheen_View_VIEW_ISO, "camera.view", text) &&
           (!camera->has_zoom || check_number(camera->zoom, RANGE_ZOOM, text)) &&
           (!camera->has_zoom_x || check_number(camera->zoom_x, RANGE_ZOOM_AT, text)) &&
           (!camera->has_zoom_y || check_number(camera->zoom_y, RANGE_ZOOM_AT, text));
}

/* A FRAME must have all of the camera that was used. */
static bool check_whole_camera(const sheen_Camera *camera, char *text)
{
    if (!camera->has_eye || !camera->has_target || !camera->has_up ||
        (!camera->has_fov_deg && !camera->has_ortho_height))
        return check_refuse(text, "camera lacks a field; a frame has them all");
    return check_camera(camera, text);
}

static bool check_period(const sheen_Pattern *pattern, char *text)
{
    const struct {
        bool is_there;
        double value;
        enum range_name range;
    } numbers[] = {
        {pattern->has_count, pattern->count, RANGE_PATTERN_COUNT},
        {pattern->has_period, pattern->period, RANGE_PATTERN_PERIOD},
        {pattern->has_duty, pattern->duty, RANGE_PATTERN_DUTY},
        {pattern->has_rotation_deg, pattern->rotation_deg, RANGE_PATTERN_ROTATION},
        {pattern->has_offset, pattern->offset, RANGE_PATTERN_OFFSET},
        {pattern->has_soft, pattern->soft, RANGE_PATTERN_SOFT},
        {pattern->has_opacity, pattern->opacity, RANGE_PATTERN_OPACITY},
        {pattern->has_width, pattern->width, RANGE_PATTERN_WIDTH},
    };
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (numbers[i].is_there && !check_number(numbers[i].value, numbers[i].range, text))
            return false;
    return true;
}

static bool check_single_lines(const sheen_Pattern *pattern, char *text)
{
    bool is_lines = pattern->kind == sheen_PatternKind_PATTERN_LINES;
    if (is_lines != (pattern->at_count > 0))
        return check_refuse(text,
                            "pattern.at: the places of 1 to 16 lines belong to a lines pattern and "
                            "to no other");
    for (size_t i = 0; i < pattern->at_count; i++)
        if (!check_number(pattern->at[i], RANGE_PATTERN_AT, text))
            return false;
    return true;
}

static bool check_pattern(const sheen_Pattern *pattern, char *text)
{
    if (!check_enum(pattern->kind, sheen_PatternKind_PATTERN_DISTANCE, "pattern.kind", text) ||
        !check_period(pattern, text) || !check_single_lines(pattern, text))
        return false;
    if (pattern->has_foreground && !check_colour(&pattern->foreground, "pattern.foreground", text))
        return false;
    if (pattern->has_background && !check_colour(&pattern->background, "pattern.background", text))
        return false;
    if (pattern->has_image_sha256 != (pattern->kind == sheen_PatternKind_PATTERN_IMAGE))
        return check_refuse(text,
                            "pattern.image_sha256 belongs to an image pattern and to no other");
    return true;
}

bool message_check_model_query(const sheen_ModelQuery *query, char text[static MESSAGE_TEXT_BYTES])
{
    static const uint8_t zeros[sizeof query->sha256] = {0};
    if (!query->has_file)
        return true;
    if (memcmp(query->sha256, zeros, sizeof zeros) != 0)
        return check_refuse(text, "sha256 and file exclude each other: with file, sha256 is zeros");
    return (*query->file || check_refuse(text, "file is empty")) &&
           check_text(query->file, "file", text);
}

static bool check_edge(const sheen_Vec3 *edge, const char *field, char *text)
{
    const double value[3] = {edge->x, edge->y, edge->z};
    char name[64];
    snprintf(name, sizeof name, "the length of %s", field);
    return check_vec3(edge, field, text) &&
           check_named(range_length(value), &RANGES[RANGE_LIGHT_SIDE], name, text);
}

static bool check_light(const sheen_Light *light, char *text)
{
    if (!check_enum(light->kind, sheen_LightKind_LIGHT_SPHERE, "light.kind", text) ||
        (light->has_pattern && !check_pattern(&light->pattern, text)))
        return false;
    bool is_tunnel = !light->has_kind && !light->has_centre; /* then the server chooses a tunnel */
    bool has_sides = !is_tunnel && (light->kind == sheen_LightKind_LIGHT_RECTANGLE ||
                                    light->kind == sheen_LightKind_LIGHT_PLANE);
    if (light->one_sided && !has_sides)
        return check_refuse(
            text, "light.one_sided is for rectangles and planes; a tunnel and a sphere are "
                  "seen from inside");
    if (light->has_centre != light->has_u || light->has_u != light->has_v)
        return check_refuse(text, "light.centre, light.u and light.v come together");
    if (!light->has_centre)
        return true;
    if (!check_vec3(&light->centre, "light.centre", text) ||
        !check_edge(&light->u, "light.u", text) || !check_edge(&light->v, "light.v", text))
        return false;
    return !is_parallel(&light->u, &light->v) ||
           check_refuse(text, "light.u and light.v (--light-u, --light-v) span no light: they are "
                              "parallel");
}

static bool check_direction(const sheen_Vec3 *v, const char *field, char *text)
{
    if (!check_vec3(v, field, text))
        return false;
    return !is_zero(v) || check_refuse(text, "%s is 0,0,0, no direction", field);
}

/* Checks the fields of line families. */
static bool check_lines(const sheen_Lines *lines, char *text)
{
    if (!check_enum(lines->family, sheen_LineFamily_LINES_ENVIRONMENT, "lines.family", text))
        return false;
    bool takes_direction = lines->family == sheen_LineFamily_LINES_ISOPHOTE ||
                           lines->family == sheen_LineFamily_LINES_ZEBRA ||
                           lines->family == sheen_LineFamily_LINES_ENVIRONMENT;
    if (lines->has_direction && !takes_direction)
        return check_refuse(text, "lines.direction belongs to isophote, zebra and environment");
    if (lines->has_eye && lines->has_eye_direction)
        return check_refuse(text, "lines.eye and lines.eye_direction exclude each other");
    return (!lines->has_direction || check_direction(&lines->direction, "lines.direction", text)) &&
           (!lines->has_eye || check_vec3(&lines->eye, "lines.eye", text)) &&
           (!lines->has_eye_direction ||
            check_direction(&lines->eye_direction, "lines.eye_direction", text));
}

/* Bands of distance need a light that is not at infinity, because only then a ray has a length. */
static bool check_distances(const sheen_Lines *lines, const sheen_Light *light, char *text)
{
    if (!light->has_pattern || light->pattern.kind != sheen_PatternKind_PATTERN_DISTANCE)
        return true;
    bool near = lines->family == sheen_LineFamily_LINES_REFLECTION ||
                lines->family == sheen_LineFamily_LINES_HIGHLIGHT;
    return (near && light->kind != sheen_LightKind_LIGHT_SPHERE) ||
           check_refuse(
               text, "pattern distance needs a light that is not at infinity: rectangle, plane or "
                     "tunnel, with reflection or highlight lines");
}

static bool check_lights(const sheen_Lines *lines, const sheen_Light *lights, size_t n, char *text)
{
    if (!check_lines(lines, text))
        return false;
    for (size_t i = 0; i < n; i++)
        if (!check_light(&lights[i], text) || !check_distances(lines, &lights[i], text))
            return false;
    return true;
}

/* "" if the planes suit the encoding, else what they must be. */
static const char *planes_wanted(uint32_t planes, unsigned encoding)
{
    if (planes == 0)
        return "at least one";
    if (planes & ~CODEC_ALL_PLANES)
        return "bits 0 to 7";
    bool picture = encoding == sheen_Encoding_ENCODING_PNG ||
                   encoding == sheen_Encoding_ENCODING_JPEG ||
                   encoding == sheen_Encoding_ENCODING_TIFF;
    return picture && planes != sheen_Plane_PLANE_COLOUR ? "1 (colour) for PNG, JPEG and TIFF" : "";
}

static bool check_planes(uint32_t planes, unsigned encoding, char *text)
{
    if (!check_enum(encoding, sheen_Encoding_ENCODING_TIFF, "encoding", text))
        return false;
    const char *wanted = planes_wanted(planes, encoding);
    return !*wanted || check_refuse(text, "planes is %u; it must be %s", planes, wanted);
}

bool message_check_hello(const sheen_Hello *hello, char text[static MESSAGE_TEXT_BYTES])
{
    return check_text(hello->client, "client", text);
}

bool message_check_upload_begin(const sheen_UploadBegin *begin,
                                char text[static MESSAGE_TEXT_BYTES])
{
    if (!check_enum(begin->kind, sheen_UploadKind_UPLOAD_IMAGE, "kind", text) ||
        !check_text(begin->name, "name", text))
        return false;
    return (begin->size_bytes > 0 && begin->size_bytes <= PROTOCOL_MAX_UPLOAD_BYTES) ||
           check_refuse(text, "size_bytes is %llu; it must be from 1 to %llu",
                        (unsigned long long)begin->size_bytes,
                        (unsigned long long)PROTOCOL_MAX_UPLOAD_BYTES);
}

static bool check_surface(const sheen_Render *render, char *text)
{
    bool exact = !render->has_surface || render->surface == sheen_SurfaceKind_SURFACE_EXACT;
    if (render->has_surface &&
        !check_enum(render->surface, sheen_SurfaceKind_SURFACE_WIREFRAME, "surface", text))
        return false;
    if (exact && render->has_surface_level && render->surface_level > 0)
        return check_refuse(text, "surface_level is %u; the exact surface has none",
                            render->surface_level);
    return !render->has_surface_level || check_number(render->surface_level, RANGE_LEVEL, text);
}

uint32_t message_render_planes(const sheen_Render *render)
{
    static const uint32_t painted_from[] = {
        [sheen_ShowKind_SHOW_CURVATURE] = sheen_Plane_PLANE_CURVATURE | sheen_Plane_PLANE_POSITION,
        [sheen_ShowKind_SHOW_GAUSSIAN] = sheen_Plane_PLANE_CURVATURE | sheen_Plane_PLANE_POSITION,
        [sheen_ShowKind_SHOW_MEAN] = sheen_Plane_PLANE_CURVATURE | sheen_Plane_PLANE_POSITION,
        [sheen_ShowKind_SHOW_NORMAL] = sheen_Plane_PLANE_NORMAL | sheen_Plane_PLANE_POSITION,
        [sheen_ShowKind_SHOW_PTEX] = sheen_Plane_PLANE_PTEX,
        [sheen_ShowKind_SHOW_DRAFT] = sheen_Plane_PLANE_NORMAL | sheen_Plane_PLANE_POSITION,
    };
    bool covers = render->show.kind != sheen_ShowKind_SHOW_LINES && !render->unfiltered &&
                  !render->aliased && render->surface == sheen_SurfaceKind_SURFACE_EXACT;
    return render->planes | painted_from[render->show.kind] |
           (covers ? sheen_Plane_PLANE_COVERAGE : sheen_Plane_PLANE_NONE);
}

static bool check_show(const sheen_Render *render, char *text)
{
    const sheen_Show *show = &render->show;
    if (!check_enum(show->kind, sheen_ShowKind_SHOW_DRAFT, "show.kind", text))
        return false;
    bool is_draft = show->kind == sheen_ShowKind_SHOW_DRAFT;
    bool is_scale = is_draft || show->kind == sheen_ShowKind_SHOW_CURVATURE ||
                    show->kind == sheen_ShowKind_SHOW_GAUSSIAN ||
                    show->kind == sheen_ShowKind_SHOW_MEAN;
    if (show->has_direction != is_draft)
        return check_refuse(text,
                            "show.direction belongs to draft, which needs it, and to no other");
    if (is_draft && !check_direction(&show->direction, "show.direction", text))
        return false;
    if (show->has_range && !is_scale)
        return check_refuse(text,
                            "show.range (--show-range) is for curvature, gaussian, mean and draft");
    if (show->has_range &&
        !check_number(show->range, is_draft ? RANGE_SHOW_DRAFT : RANGE_SHOW_CURVATURE, text))
        return false;
    if (show->kind == sheen_ShowKind_SHOW_LINES)
        return true;
    if (!(render->planes & sheen_Plane_PLANE_COLOUR))
        return check_refuse(text, "planes is %u; show paints colour, bit 0", render->planes);
    return !render->has_surface || render->surface != sheen_SurfaceKind_SURFACE_WIREFRAME ||
           check_refuse(text, "show paints surfaces; a wireframe has none");
}

static bool check_schedule(const sheen_Render *render, char *text)
{
    if (!check_enum(render->request_class, sheen_RequestClass_CLASS_BATCH, "request_class", text))
        return false;
    if (render->has_view && render->request_class == sheen_RequestClass_CLASS_BATCH)
        return check_refuse(text, "view is for interactive requests and stills; a batch is never "
                                  "replaced");
    return !render->has_deadline_ms || check_number(render->deadline_ms, RANGE_DEADLINE, text);
}

static bool check_side(uint32_t side_px, uint32_t max_px, unsigned encoding, const char *name,
                       char *text)
{
    struct range range = RANGES[RANGE_SIDE];
    range.option = NULL;
    if (range_holds(&range, side_px) && side_px > max_px)
        return check_refuse(text,
                            "%s is %u; it must be from 1 to %u pixels, the device's own limit",
                            name, side_px, max_px);
    if (!check_named(side_px, &range, name, text))
        return false;
    return encoding != sheen_Encoding_ENCODING_JPEG ||
           range_holds(&RANGES[RANGE_JPEG_SIDE], side_px) ||
           check_refuse(text, "%s is %u; a JPEG file has at most %g pixels: ask for another format",
                        name, side_px, RANGES[RANGE_JPEG_SIDE].greatest);
}

static bool check_jpeg(const sheen_Render *render, char *text)
{
    if ((render->has_jpeg_quality || render->has_jpeg_subsampling) &&
        render->encoding != sheen_Encoding_ENCODING_JPEG)
        return check_refuse(text, "jpeg_quality and jpeg_subsampling (--jpeg-quality, "
                                  "--jpeg-subsampling) are for JPEG files");
    if (render->has_jpeg_quality && !check_number(render->jpeg_quality, RANGE_JPEG_QUALITY, text))
        return false;
    return !render->has_jpeg_subsampling ||
           check_enum(render->jpeg_subsampling, sheen_JpegSubsampling_JPEG_420, "jpeg_subsampling",
                      text);
}

static bool check_window(const sheen_Render *render, char text[static MESSAGE_TEXT_BYTES])
{
    const sheen_Window *window = &render->window;
    bool ok = check_named(window->x_px, &RANGES[RANGE_WINDOW_AT], "window.x_px", text) &&
              check_named(window->y_px, &RANGES[RANGE_WINDOW_AT], "window.y_px", text) &&
              check_named(window->width_px, &RANGES[RANGE_WINDOW_SIDE], "window.width_px", text) &&
              check_named(window->height_px, &RANGES[RANGE_WINDOW_SIDE], "window.height_px", text);
    if (!ok)
        return false;
    return (floor(window->x_px) + render->width_px <= window->width_px &&
            floor(window->y_px) + render->height_px <= window->height_px) ||
           check_refuse(text,
                        "window: %ux%u pixels at %.9g,%.9g are not inside of a picture of %ux%u",
                        render->width_px, render->height_px, window->x_px, window->y_px,
                        window->width_px, window->height_px);
}

bool message_check_render(const sheen_Render *render, uint32_t max_width_px, uint32_t max_height_px,
                          char text[static MESSAGE_TEXT_BYTES])
{
    if (!check_side(render->width_px, max_width_px, render->encoding, "width", text) ||
        !check_side(render->height_px, max_height_px, render->encoding, "height", text) ||
        !check_planes(render->planes, render->encoding, text) || !check_jpeg(render, text) ||
        !check_show(render, text))
        return false;
    struct codec_layout layout;
    uint32_t planes = message_render_planes(render);
    if (!codec_layout_init(&layout, render->width_px, render->height_px, planes))
        return check_refuse(text, "%ux%u px with planes %u is over %llu bytes or %u px a side",
                            render->width_px, render->height_px, planes,
                            (unsigned long long)PROTOCOL_MAX_FRAME_BYTES, PROTOCOL_MAX_SIZE_PX);
    return check_schedule(render, text) &&
           (!render->has_camera || check_camera(&render->camera, text)) &&
           (!render->has_window || check_window(render, text)) &&
           check_lights(&render->lines, render->lights, render->lights_count, text) &&
           check_surface(render, text) &&
           check_colours(render->has_miss ? &render->miss : NULL,
                         render->has_empty ? &render->empty : NULL,
                         render->has_base ? &render->base : NULL, text);
}

static bool check_extreme(const sheen_Frame *frame, const sheen_Extreme *extreme, const char *field,
                          char *text)
{
    if (!isfinite(extreme->value))
        return check_refuse(text, "%s.value is no finite number", field);
    if (extreme->has_x_px != extreme->has_y_px || extreme->has_x_px != extreme->has_position ||
        extreme->x_px >= frame->width_px || extreme->y_px >= frame->height_px)
        return check_refuse(text, "%s has no pixel of the frame, with its position", field);
    if (extreme->has_face != extreme->has_u || extreme->has_u != extreme->has_v ||
        !(extreme->u >= 0 && extreme->u <= 1 && extreme->v >= 0 && extreme->v <= 1))
        return check_refuse(text, "%s: face, u and v come together, u and v from 0 to 1", field);
    return !extreme->has_position || check_vec3(&extreme->position, field, text);
}

static bool check_extremes(const sheen_Frame *frame, char *text)
{
    if (frame->has_show_least != frame->has_show_greatest)
        return check_refuse(text, "show_least and show_greatest come together");
    if (!frame->has_show_least)
        return true;
    return check_extreme(frame, &frame->show_least, "show_least", text) &&
           check_extreme(frame, &frame->show_greatest, "show_greatest", text) &&
           (frame->show_least.value <= frame->show_greatest.value ||
            check_refuse(text, "show_least is above show_greatest"));
}

bool check_whole_scene(const sheen_Camera *camera, const sheen_Lines *lines,
                       const sheen_Light *lights, size_t n, char *text)
{
    if (n == 0)
        return check_refuse(text, "an answer has a light");
    for (size_t i = 0; i < n; i++)
        if (!lights[i].has_centre || !lights[i].has_pattern)
            return check_refuse(text, "a light lacks a field; an answer has them all");
    return check_whole_camera(camera, text) && check_lights(lines, lights, n, text);
}

static bool check_frame(const sheen_Frame *frame, char *text)
{
    struct codec_layout layout;
    if (!check_planes(frame->planes, frame->encoding, text))
        return false;
    if (!codec_layout_init(&layout, frame->width_px, frame->height_px, frame->planes))
        return check_refuse(text, "%ux%u px is no frame's size", frame->width_px, frame->height_px);
    if (frame->data_bytes == 0 || frame->data_bytes > PROTOCOL_MAX_FRAME_BYTES)
        return check_refuse(text, "data_bytes is %llu; it must be from 1 to %llu",
                            (unsigned long long)frame->data_bytes,
                            (unsigned long long)PROTOCOL_MAX_FRAME_BYTES);
    if (frame->has_show_range &&
        !check_named(frame->show_range, &RANGES[RANGE_SHOW_CURVATURE], "show_range", text))
        return false;
    if (frame->has_light_share && !(frame->light_share >= 0 && frame->light_share <= 1))
        return check_refuse(text, "light_share is %g; it must be from 0 to 1", frame->light_share);
    if ((frame->has_up && !check_direction(&frame->up, "up", text)) ||
        (frame->has_up_source &&
         !check_enum(frame->up_source, sheen_UpSource_UP_GUESSED, "up_source", text)))
        return false;
    if (!check_extremes(frame, text))
        return false;
    if (!check_colours(frame->has_miss ? &frame->miss : NULL,
                       frame->has_empty ? &frame->empty : NULL,
                       frame->has_base ? &frame->base : NULL, text))
        return false;
    return check_whole_scene(&frame->camera, &frame->lines, frame->lights, frame->lights_count,
                             text) &&
           check_text(frame->device, "device", text) && check_text(frame->driver, "driver", text) &&
           check_text(frame->server, "server", text);
}

static bool check_model_info(const sheen_ModelInfo *info, char *text)
{
    if (!message_is_text(info->warnings, true))
        return check_refuse(text, "warnings are not lines of UTF-8 text");
    for (pb_size_t i = 0; i < info->findings_count; i++)
        if (info->findings[i].count == 0 ||
            (info->findings[i].has_line && info->findings[i].line == 0))
            return check_refuse(text, "findings[%u] is of nothing, or on line 0", (unsigned)i);
    return check_text(info->name, "name", text) && check_vec3(&info->box_min, "box_min", text) &&
           check_vec3(&info->box_max, "box_max", text);
}

bool message_check_answer(uint8_t type, const void *body, char text[static MESSAGE_TEXT_BYTES])
{
    switch (type) {
    case MESSAGE_HELLO_OK: {
        const sheen_HelloOk *ok = body;
        if (ok->credits == 0 || ok->credits > PROTOCOL_MAX_CREDITS)
            return check_refuse(text, "credits is %u; it must be from 1 to %u", ok->credits,
                                PROTOCOL_MAX_CREDITS);
        return check_text(ok->server, "server", text) && check_text(ok->device, "device", text) &&
               check_text(ok->driver, "driver", text);
    }
    case MESSAGE_UPLOAD_STATE:
        return true;
    case MESSAGE_SUPERSEDED:
        return ((const sheen_Superseded *)body)->by != 0 ||
               check_refuse(text, "by is 0, which is no request's number");
    case MESSAGE_MODEL_INFO:
        return check_model_info(body, text);
    case MESSAGE_FRAME:
        return check_frame(body, text);
    case MESSAGE_BREAKS:
        return check_breaks(body, text);
    case MESSAGE_COMPARED:
        return check_compared(body, text);
    case MESSAGE_CURVES:
        return check_curves(body, text);
    case MESSAGE_PROGRESS:
        return check_text(((const sheen_Progress *)body)->stage, "stage", text);
    case MESSAGE_STATS: {
        const sheen_Stats *stats = body;
        return check_text(stats->server, "server", text) &&
               check_text(stats->device, "device", text) &&
               check_text(stats->driver, "driver", text);
    }
    case MESSAGE_ERROR: {
        const sheen_Error *error = body;
        if (error->code == sheen_ErrorCode_ERROR_NONE)
            return check_refuse(text, "code is 0; an error has one");
        return check_enum(error->code, sheen_ErrorCode_ERROR_GPU_LOST, "code", text) &&
               check_text(error->text, "text", text);
    }
    default:
        return check_refuse(text, "a server sends no %s", message_type_name(type));
    }
}
