/* What a frame shows: camera, line family, lights and patterns. shaders/README.md has the formulas.
 * protocol/ranges.h has the ranges of all numbers, by the names used here (RANGE_FOV);
 * request_check() checks them. Plain data, owned by the caller. */
#ifndef SHEEN_SCENE_SCENE_H
#define SHEEN_SCENE_SCENE_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

enum { MAX_LIGHTS = 8, MAX_LINES = 16 };

struct renderer_image;

/* The picture of which a frame shows a part, in pixels: its size, and the place of the frame's top
 * left corner in it. The part is inside. All 0: the frame is the whole picture. Ranges:
 * RANGE_WINDOW_AT, RANGE_WINDOW_SIDE. */
struct camera_window {
    double x, y;
    uint32_t width_px, height_px;
};

enum camera_kind { CAMERA_PERSPECTIVE, CAMERA_ORTHOGRAPHIC };
/* World units, right-handed. up need not be perpendicular to target - eye, but must not be parallel
 * to it. */
struct camera {
    enum camera_kind kind;
    double eye[3], target[3], up[3];
    double fov_deg; /* perspective: vertical field of view, RANGE_FOV */
    /* Orthographic: height of the picture in world units, RANGE_ORTHO_HEIGHT. */
    double ortho_height;
    struct camera_window window;
};

/* True if two cameras are equal, bit by bit. */
static inline bool camera_is_same(const struct camera *a, const struct camera *b)
{
    return a->kind == b->kind && !memcmp(a->eye, b->eye, sizeof a->eye) &&
           !memcmp(a->target, b->target, sizeof a->target) && !memcmp(a->up, b->up, sizeof a->up) &&
           a->fov_deg == b->fov_deg && a->ortho_height == b->ortho_height &&
           a->window.x == b->window.x && a->window.y == b->window.y &&
           a->window.width_px == b->window.width_px && a->window.height_px == b->window.height_px;
}

/* The direction from which a camera that frames the model looks. e1 is the world's x axis made
 * horizontal (y if x is up), e2 = up x e1: the front is at -e2, the right at e1. VIEW_AROUND looks
 * down by 45 degrees from the front right, with the model's longer side across the picture.
 * VIEW_ISO looks from e1 - e2 + up, so that all three axes are equally long in an orthographic
 * picture. */
enum default_view {
    VIEW_AROUND,
    VIEW_FRONT,
    VIEW_BACK,
    VIEW_LEFT,
    VIEW_RIGHT,
    VIEW_TOP,
    VIEW_BOTTOM,
    VIEW_ISO,
};

enum pattern_kind {
    PATTERN_STRIPES,
    PATTERN_LATTICE,
    PATTERN_CIRCLES,
    PATTERN_IMAGE,
    PATTERN_LINES,
    PATTERN_RAINBOW,
    PATTERN_DISTANCE,
};
/* The pattern that a light shows. Colours are RGBA as displayed, in RANGE_COLOUR. */
struct pattern {
    enum pattern_kind kind;
    double count;        /* periods across the light's width */
    double period;       /* length of a period in the light's units; 0: `count` decides */
    double duty;         /* bright share of a period */
    double rotation_deg; /* rotation on the light */
    double offset;       /* shift in periods */
    /* Width of a soft edge: share of a period, for PATTERN_LINES of the line's width. */
    double soft;
    double opacity;               /* opacity over the shaded surface */
    double at[MAX_LINES];         /* LINES: places, in widths of the light */
    uint32_t n_at;                /* LINES: number of places, from 1 */
    double width;                 /* LINES: width of each, in widths of the light */
    float foreground[4];          /* colour of the bright part */
    float background[4];          /* colour of the dark part */
    struct renderer_image *image; /* IMAGE; must outlive the frame */
};

enum light_kind { LIGHT_RECTANGLE, LIGHT_PLANE, LIGHT_TUNNEL, LIGHT_SPHERE };
/* u and v must not be parallel.
 *
 * rectangle  x = centre + (s - 1/2) u + (t - 1/2) v with s and t in [0,1]
 * plane      the same with any s and t
 * tunnel     |u| is the radius, v the axis
 * sphere     at infinity; v is the axis, centre is not used */
struct light {
    enum light_kind kind;
    double centre[3], u[3], v[3];
    bool one_sided; /* seen only by rays that run against u x v; else from both sides */
    bool is_chosen; /* its place was chosen by the model's box (defaults.h) */
    struct pattern pattern;
};

enum line_family {
    LINES_REFLECTION,
    LINES_HIGHLIGHT,
    LINES_ISOPHOTE,
    LINES_ZEBRA,
    LINES_ENVIRONMENT,
};

/* The eye for which the lines are computed. */
enum line_eye_kind { LINE_EYE_CAMERA, LINE_EYE_POINT, LINE_EYE_DIRECTION };
struct lines {
    enum line_family family;
    bool has_direction;
    double direction[3]; /* ISOPHOTE: compared with the normal; ZEBRA, ENVIRONMENT: the axis */
    enum line_eye_kind eye_kind;
    double eye[3]; /* a point, or a direction of view, which is not zero */
};

/* What is drawn: the limit surface; or, as in the conventional picture, the polygons of the cage
 * subdivided `level` times (RANGE_LEVEL), with vertices and normals on the limit surface,
 * interpolated in between (mesh.h); or the edges of those polygons. */
enum surface_kind { SURFACE_EXACT, SURFACE_POLYGON, SURFACE_WIREFRAME };
struct surface {
    enum surface_kind kind;
    uint32_t level; /* SURFACE_EXACT: 0 */
};

#endif
