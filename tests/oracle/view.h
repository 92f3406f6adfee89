/* Cameras, written independently of server/render/view.h: right-handed world, pixel (0,0) top left
 * with its centre at (0.5, 0.5), vertical field of view. */
#ifndef SHEEN_TESTS_ORACLE_VIEW_H
#define SHEEN_TESTS_ORACLE_VIEW_H

#include <string>
#include <vector>

#include "tests/oracle/model.h"
#include "tests/oracle/vec.h"

struct view {
    std::string name;
    bool chosen_by_sheen = false; /* no camera on the command line; it is read from --json */
    bool orthographic = false;
    vec3 eye, target, up;
    double fov_deg = 0, ortho_height = 0;
    int width_px = 0, height_px = 0;
};

/* A point on the picture: x and y in pixels, depth along the view direction in world units. */
struct projected {
    double x, y, depth;
};

/* A view ready to project: unit axes and pixels per unit. */
class projector
{
  public:
    explicit projector(const view &view);
    projected project(vec3 p) const;
    /* The ray through a point of the picture; its direction has length 1. */
    void ray(double x, double y, vec3 *origin, vec3 *direction) const;
    /* False only if no point of the sphere is in the picture, or none is in front of the eye. */
    bool may_see(vec3 centre, double radius) const;
    bool orthographic() const
    {
        return is_orthographic;
    }

  private:
    bool is_orthographic;
    vec3 eye, right, up, forward;
    double half_width, half_height; /* px */
    double scale;                   /* px per unit, at depth 1 for perspective */
};

/* The options of `sheen render` for this view; every number with 17 digits. */
std::vector<std::string> view_options(const view &view);

/* The views of each model: sheen's default, two of the whole model (perspective and orthographic),
 * and one close to an irregular vertex, if there is one. */
std::vector<view> model_views(const model &model, int width_px, int height_px);

/* A view so close to a smooth place that a pixel is 10^-7 of a face: positions in single precision
 * no longer distinguish pixels, but the surface must still fill the picture. */
view zoomed_view(const model &model, int width_px, int height_px);

/* Fills in the camera that `sheen render --json` reports. False if it reports none. */
bool read_camera(const std::string &json, view *view);

std::string comma_separated(vec3 v);

#endif
