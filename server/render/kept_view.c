#include "server/render/kept_view.h"

enum { SMALL_PX = 4096 };

struct kept_view kept_view_of(uint64_t model_serial, const struct frame_request *request)
{
    bool is_exact = request->surface.kind == SURFACE_EXACT;
    return (struct kept_view){
        .model_serial = model_serial,
        .width_px = request->width_px,
        .height_px = request->height_px,
        .camera = request->camera,
        .surface = request->surface,
        .ptex = request->planes & PLANE_PTEX || !is_exact, /* polygons always write it */
        .edges = request_has_coverage(request),
        .any_cut = is_exact,
    };
}

bool kept_view_serves(const struct kept_view *kept, uint64_t model_serial,
                      const struct frame_request *request)
{
    return kept->model_serial == model_serial && kept->width_px == request->width_px &&
           kept->height_px == request->height_px &&
           camera_is_same(&kept->camera, &request->camera) &&
           kept->surface.kind == request->surface.kind &&
           kept->surface.level == request->surface.level &&
           (kept->ptex || !(request->planes & PLANE_PTEX)) &&
           (kept->edges || !request_has_coverage(request));
}

bool kept_view_is_small(const struct frame_request *request)
{
    return (uint64_t)request->width_px * request->height_px < SMALL_PX;
}
