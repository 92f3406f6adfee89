/* Line families, lights and patterns by the formulas of shaders/README.md, in double precision and
 * for one sample: written only from those formulas, so that it can judge the shaders. FAKE_FAULTS
 * breaks some of them, for self_test.sh. */
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

struct rgba { /* [0,1]: sRGB with straight alpha, or linear light, premultiplied */
    double r = 0, g = 0, b = 0, a = 1;
};

/* An image on a light, interpolated bilinearly between the centres of its texels. */
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
    std::shared_ptr<const line_image> image; /* not rotated, and opaque over the base */
    rgba foreground = {1, 1, 1, 1}, background = {0, 0, 0, 1};
};

struct line_light {
    line_light_kind kind = line_light_kind::rectangle;
    bool one_sided = false;
    vec3 centre, u, v;
    line_pattern pattern;
};

/* Everything that determines a frame's lines. */
struct line_setup {
    line_family family = line_family::reflection;
    bool has_axis = false;
    vec3 axis; /* isophote, zebra, environment */
    line_eye_kind eye_kind = line_eye_kind::camera;
    vec3 eye; /* the point, or the direction of view */
    std::vector<line_light> lights;
    /* sheen's default colours, from #rrggbb */
    rgba base = {0xb3 / 255.0, 0xb8 / 255.0, 0xbf / 255.0, 1};
    rgba miss = {0x29 / 255.0, 0x30 / 255.0, 0x3b / 255.0, 1};

    /* True if the first light is met, and not only its pattern is used. */
    bool meets_lights() const
    {
        return family == line_family::reflection || family == line_family::highlight;
    }
};

/* The place where the ray of a surface point meets a light. */
struct light_hit {
    bool met = false;
    double s = 0, t = 0;
    double tau = 0; /* length of the ray; 0 for a light at infinity */
    double width = 0, height = 0;
    bool s_wraps = false, t_wraps = false; /* 0 and 1 are the same place */
    bool s_ends = false,
         t_ends = false; /* beyond 0 and 1 an image's edge continues; else the image repeats */
    double inside = 0;   /* distance inside of the light's border, in s or t; negative: outside */
};

class line_tracer
{
  public:
    line_tracer(const line_setup &setup, const view &camera);
    /* Meets the light for surface point x with unit normal n, by the winding. */
    light_hit meet(vec3 x, vec3 n, const line_light &light) const
    {
        return meet_along(sight(x, n), x, n, light);
    }
    /* The unit direction from the line eye to x. */
    vec3 sight(vec3 x, vec3 n) const;
    /* As meet(), for a line eye that sees x in direction v. */
    light_hit meet_along(vec3 v, vec3 x, vec3 n, const line_light &light) const;
    /* The displayed colour of one sample at x, all lights combined. */
    rgba colour(vec3 x, vec3 n) const;
    /* As colour(), in linear light, premultiplied. Sets the bits of lights that are met in *met. */
    rgba light(vec3 x, vec3 n, unsigned *met) const;
    /* True if rounding decides to which side a highlight's normal points. */
    bool at_turn(vec3 x, vec3 n) const;
    const line_setup setup;

  private:
    vec3 view_from_camera(vec3 x) const;
    /* The angle by which single precision may turn the view, rad; 1 or more at the line eye
     * itself. */
    double eye_noise(vec3 x) const;
    view camera;
    vec3 forward, camera_up;
    rgba base_light, miss_light;
};

/* The colour of a pattern at a place on its light, in linear light: foreground or background, or
 * between them at a soft edge. Without opacity. */
rgba pattern_colour(const line_pattern &pattern, const light_hit &hit);

/* The distance of two places in a pattern: in periods, in widths of single lines, or in texels. */
double pattern_distance(const line_pattern &pattern, const light_hit &a, const light_hit &b);

/* Converts a displayed colour with straight alpha to linear light, premultiplied; and back. */
rgba to_light(const rgba &displayed);
rgba to_displayed(const rgba &light);

/* Mixes as light, b's share of it. */
rgba mixed(const rgba &a, const rgba &b, double b_share);

/* a - b for coordinates of a light, the short way around where they wrap. */
double coordinate_difference(double a, double b, bool wraps);

/* The options of `sheen render` for the setup; every number with 17 digits. */
std::vector<std::string> line_options(const line_setup &setup);

#endif
