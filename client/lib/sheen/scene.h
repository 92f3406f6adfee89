/* What a picture shows: camera, lights with their patterns, and the lines on the surface. Plain
 * data, which requests and results share. sheen.h has the rules. */
#ifndef SHEEN_PUBLIC_SCENE_H
#define SHEEN_PUBLIC_SCENE_H

#include "base.h"

#include <stdbool.h>
#include <stdint.h>

SHEEN_DECLARATIONS_BEGIN

enum sheen_projection {
    SHEEN_PROJECTION_AUTO, /* the daemon frames the model; other members are ignored */
    SHEEN_PROJECTION_PERSPECTIVE,
    SHEEN_PROJECTION_ORTHOGRAPHIC,
};

/* Where a model's up direction comes from. */
enum sheen_up_source {
    SHEEN_UP_GIVEN,   /* the request */
    SHEEN_UP_FILE,    /* the model's file: y in glTF, upAxis in USD */
    SHEEN_UP_GUESSED, /* guessed: z, or y if the model is thinner in y by more than 1 % */
    SHEEN_UP_UNKNOWN, /* the daemon is too old to tell */
};

/* The direction from which a camera that frames the model looks (protocol/README.md, chapter 4). */
enum sheen_view {
    /* From above the front right; the model's longer side lies across the picture. */
    SHEEN_VIEW_AROUND,
    SHEEN_VIEW_FRONT,
    SHEEN_VIEW_BACK,
    SHEEN_VIEW_LEFT,
    SHEEN_VIEW_RIGHT,
    SHEEN_VIEW_TOP,
    SHEEN_VIEW_BOTTOM,
    SHEEN_VIEW_ISO,
};

struct sheen_camera {
    enum sheen_projection projection;
    /* The daemon chooses eye and target, or up, so that the model fills the picture. */
    bool auto_view, auto_up;
    bool has_target;      /* with auto_view: the camera looks at `target` */
    enum sheen_view view; /* with auto_view */
    double zoom;          /* magnification with the same eye, 1 to 1e6; 0: none */
    /* The place of the picture that is magnified: x from the left and y from the top, 0 to 1. */
    double zoom_at[2];
    double eye[3], target[3]; /* must differ; all coordinates are -1e30 to 1e30 */
    /* Not parallel to the line of sight; need not be perpendicular to it. */
    double up[3];
    double fov_deg;      /* perspective: vertical field of view, 1e-6 to 179 */
    double ortho_height; /* orthographic: height of the picture in units, above 0 to 1e30 */
};

#define SHEEN_MAX_LIGHTS 8
#define SHEEN_MAX_LINES 16

enum sheen_pattern_kind {
    SHEEN_PATTERN_STRIPES,
    SHEEN_PATTERN_LATTICE,
    SHEEN_PATTERN_CIRCLES,
    SHEEN_PATTERN_IMAGE,
    SHEEN_PATTERN_LINES,    /* single lines */
    SHEEN_PATTERN_RAINBOW,  /* hue */
    SHEEN_PATTERN_DISTANCE, /* bands of equal distance along the ray; not for lights at infinity */
};

/* The pattern that a light shows. shaders/README.md of the sources has the formulas. */
struct sheen_pattern {
    enum sheen_pattern_kind kind;
    /* Periods across the light's width, above 0, at most 100000. */
    double count;
    /* Length of a period in the light's units, 1e-18 to 1e18; 0: `count` decides. */
    double period;
    double duty;                 /* bright share of a period, 0 to 1 */
    double rotation_deg, offset; /* rotation; offset in periods; each -1e6 to 1e6 */
    /* Width of each soft edge, as a share of a period (SHEEN_PATTERN_LINES: of the line's width), 0
     * to 1. */
    double soft;
    double opacity; /* opacity over the shaded surface, 0 to 1 */
    /* SHEEN_PATTERN_LINES: number of lines, 1 to SHEEN_MAX_LINES; else 0. */
    uint32_t n_at;
    /* SHEEN_PATTERN_LINES: place (-1e6 to 1e6) and width (above 0 to 1) of the lines, in widths of
     * the light. */
    double at[SHEEN_MAX_LINES], width;
    bool has_colours;                   /* false: white on black */
    float foreground[4], background[4]; /* RGBA in [0, 1], as displayed */
    uint8_t image_id[SHEEN_ID_BYTES];   /* SHEEN_PATTERN_IMAGE: id of an uploaded image */
};
#define SHEEN_PATTERN_DEFAULTS                                                                     \
    ((struct sheen_pattern){.count = 40, .duty = 0.5, .opacity = 1, .width = 0.01})
void sheen_pattern_init(struct sheen_pattern *pattern); /* writes the defaults */

enum sheen_light_kind {
    SHEEN_LIGHT_RECTANGLE,
    SHEEN_LIGHT_PLANE,
    SHEEN_LIGHT_TUNNEL,
    SHEEN_LIGHT_SPHERE,
};

/* A light, in the model's units:
 *
 * rectangle  the points centre + (s - 1/2) u + (t - 1/2) v with s and t in [0, 1]
 * plane      the same with any s and t
 * tunnel     an endless cylinder of radius |u| whose axis runs along v through centre
 * sphere     at infinity; v is its axis */
struct sheen_light {
    enum sheen_light_kind kind;
    bool has_kind; /* false and is_placed false: a tunnel about the model, and `kind` is ignored */
    /* False: the daemon places the light about the model, and centre, u and v are ignored. */
    bool is_placed;
    bool one_sided; /* rectangle and plane: seen only by rays that run against u x v */
    double centre[3], u[3], v[3]; /* u and v: of length 1e-18 to 1e18, and not parallel */
    struct sheen_pattern pattern;
};

enum sheen_line_family {
    SHEEN_LINES_REFLECTION,
    SHEEN_LINES_HIGHLIGHT,
    SHEEN_LINES_ISOPHOTE,
    SHEEN_LINES_ZEBRA,
    SHEEN_LINES_ENVIRONMENT,
};

enum sheen_line_eye { SHEEN_LINE_EYE_CAMERA, SHEEN_LINE_EYE_POINT, SHEEN_LINE_EYE_DIRECTION };

struct sheen_lines {
    enum sheen_line_family family;
    /* Isophotes: the direction that normals are compared with; without it, the direction to the
     * eye. Zebra and environment: the axis; without it, up. */
    bool has_direction;
    double direction[3];          /* not zero */
    enum sheen_line_eye eye_kind; /* the eye for which the lines are computed */
    double eye[3];                /* a point, or a direction of view, which is not zero */
};

static inline struct sheen_pattern sheen_pattern_defaults(void)
{
    struct sheen_pattern pattern;
    sheen_pattern_init(&pattern);
    return pattern;
}

SHEEN_DECLARATIONS_END

#endif
