/* The checks of message.h, of a request to draw. */
#include <math.h>

#include "protocol/codec.h"
#include "protocol/messages/message_check.h"
#include "protocol/ranges.h"

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

bool check_planes(uint32_t planes, unsigned encoding, char *text)
{
    if (!check_enum(encoding, sheen_Encoding_ENCODING_TIFF, "encoding", text))
        return false;
    const char *wanted = planes_wanted(planes, encoding);
    return !*wanted || check_refuse(text, "planes is %u; it must be %s", planes, wanted);
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
