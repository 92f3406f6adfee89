/* Line families, lights and patterns as shaders/README.md defines them, in double and one sample at
 * a time: written from its formulas alone, so that it judges the shaders. FAKE_FAULTS breaks some
 * of them, for self_test.sh: sheen then differs from them as it would if it were wrong. */
#ifndef SHEEN_TESTS_ORACLE_LINES_H
#define SHEEN_TESTS_ORACLE_LINES_H

#include <memory>
#include <string>
#include <vector>

#include "tests/oracle/vec.h"
#include "tests/oracle/view.h"

enum class line_family { reflection, highlight, isophote, zebra, environment };
enum class line_light_kind { rectangle, plane, tunnel, sphere };
enum class line_pattern_kind { stripes, lattice, circles, lines, rainbow, distance, image };
enum class line_eye_kind { camera, point, direction };

struct rgba { /* [0,1], as displayed and straight, or linear light and premultiplied by alpha */
    double r = 0, g = 0, b = 0, a = 1;
};

/* A picture on a light. Between the middles of its texels it is interpolated bilinearly. */
struct line_image {
    std::string path; /* the file that holds it */
    int width_px = 0, height_px = 0;
    std::vector<rgba> texels; /* linear light, premultiplied; rows top first */
};

struct line_pattern {
    line_pattern_kind kind = line_pattern_kind::stripes;
    double count = 40, period = 0; /* period 0: by count */
    double duty = 0.5, rotation_deg = 0, offset = 0, soft = 0, opacity = 1;
    std::vector<double> at = {0.5};          /* lines */
    double width = 0.01;                     /* lines */
    std::shared_ptr<const line_image> image; /* neither turned nor transparent over the base */
    rgba foreground = {1, 1, 1, 1}, background = {0, 0, 0, 1};
};

struct line_light {
    line_light_kind kind = line_light_kind::rectangle;
    bool one_sided = false;
    vec3 centre, u, v;
    line_pattern pattern;
};

/* All that a frame's lines are made of. */
struct line_setup {
    line_family family = line_family::reflection;
    bool has_axis = false;
    vec3 axis; /* isophote, zebra, environment */
    line_eye_kind eye_kind = line_eye_kind::camera;
    vec3 eye; /* the point, or the direction of view */
    std::vector<line_light> lights;
    /* sheen's own, as #rrggbb says them */
    rgba base = {0xb3 / 255.0, 0xb8 / 255.0, 0xbf / 255.0, 1};
    rgba miss = {0x29 / 255.0, 0x30 / 255.0, 0x3b / 255.0, 1};

    /* Whether the first light plays a part, and not its pattern alone. */
    bool meets_lights() const
    {
        return family == line_family::reflection || family == line_family::highlight;
    }
};

/* Where the ray of a surface point meets a light. */
struct light_hit {
    bool met = false;
    double s = 0, t = 0;
    double tau = 0; /* length of the ray; 0 where the light is at infinity */
    double width = 0, height = 0;
    bool s_wraps = false, t_wraps = false; /* 0 and 1 are the same place */
    bool s_ends = false,
         t_ends = false; /* beyond 0 and 1 an image's rim goes on; else it repeats */
    double inside = 0;   /* how far within the light's border, in s or t; below 0: beyond it */
};

class line_tracer
{
  public:
    line_tracer(const line_setup &setup, const view &camera);
    /* For the surface point x with unit normal n, along the winding. */
    light_hit meet(vec3 x, vec3 n, const line_light &light) const
    {
        return meet_along(sight(x, n), x, n, light);
    }
    /* The unit direction from the line eye to x. */
    vec3 sight(vec3 x, vec3 n) const;
    /* As if the line eye were where it sees x along v. */
    light_hit meet_along(vec3 v, vec3 x, vec3 n, const line_light &light) const;
    /* The colour of one sample there, lights over each other, as displayed. */
    rgba colour(vec3 x, vec3 n) const;
    /* The same as linear light, premultiplied. Lights that are met are bits of *met. */
    rgba light(vec3 x, vec3 n, unsigned *met) const;
    /* Whether rounding decides which way a highlight's normal faces. */
    bool at_turn(vec3 x, vec3 n) const;
    const line_setup setup;

  private:
    vec3 view_from_camera(vec3 x) const;
    /* What single precision may turn the view by, rad; 1 and more at the line eye itself. */
    double eye_noise(vec3 x) const;
    view camera;
    vec3 forward, camera_up;
    rgba base_light, miss_light;
};

/* What a pattern shows at a place on its light, as linear light: foreground or background, or
 * between them where an edge is soft. Without opacity. */
rgba pattern_colour(const line_pattern &pattern, const light_hit &hit);

/* How far apart two places are in a pattern: in its periods, in widths of single lines, in texels.
 */
double pattern_distance(const line_pattern &pattern, const light_hit &a, const light_hit &b);

/* From a displayed, straight colour to linear light, premultiplied; and back. */
rgba to_light(const rgba &displayed);
rgba to_displayed(const rgba &light);

/* Mixes as light, b's share of it. */
rgba mixed(const rgba &a, const rgba &b, double b_share);

/* a - b for coordinates of a light, the short way round where they wrap. */
double coordinate_difference(double a, double b, bool wraps);

/* Options of `sheen render` for all of it; every number with 17 digits. */
std::vector<std::string> line_options(const line_setup &setup);

#endif
