/* What a frame shall show: camera, line family, lights and their patterns. The formulas are in
 * shaders/README.md, the ranges of all numbers in protocol/ranges.h, each by its name there
 * (RANGE_FOV); request_check() holds a request against them. Plain data; no ownership but what is
 * said. */
#ifndef SHEEN_SCENE_SCENE_H
#define SHEEN_SCENE_SCENE_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

enum { MAX_LIGHTS = 8, MAX_LINES = 16 };

struct renderer_image;

enum camera_kind { CAMERA_PERSPECTIVE, CAMERA_ORTHOGRAPHIC };
/* World units; right-handed. up need not be perpendicular, but not parallel to target - eye. */
struct camera {
    enum camera_kind kind;
    double eye[3], target[3], up[3];
    double fov_deg;      /* perspective: vertical field of view, RANGE_FOV */
    double ortho_height; /* orthographic: world units from top to bottom of the picture,
                            RANGE_ORTHO_HEIGHT */
};

/* Whether two cameras see the same, bit by bit. */
static inline bool camera_is_same(const struct camera *a, const struct camera *b)
{
    return a->kind == b->kind && !memcmp(a->eye, b->eye, sizeof a->eye) &&
           !memcmp(a->target, b->target, sizeof a->target) && !memcmp(a->up, b->up, sizeof a->up) &&
           a->fov_deg == b->fov_deg && a->ortho_height == b->ortho_height;
}

/* From where a camera that frames the model looks. With e1 the world's x axis made horizontal (y
 * where x is up) and e2 = up x e1: the front is at -e2, the right at e1. VIEW_AROUND looks down by
 * 45 degrees from the front right, with the model's longer side across the picture. VIEW_ISO looks
 * from e1 - e2 + up, so that all three axes are equally long in an orthographic picture. */
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
/* What a light shows. Colours are RGBA in RANGE_COLOUR, as displayed. */
struct pattern {
    enum pattern_kind kind;
    double count;                 /* periods over the light's width */
    double period;                /* the light's units; 0: by count */
    double duty;                  /* bright part of a period */
    double rotation_deg;          /* on the light */
    double offset;                /* periods */
    double soft;                  /* share of a period that an edge takes; of PATTERN_LINES, of
                                     the width */
    double opacity;               /* over the shaded base */
    double at[MAX_LINES];         /* LINES: places, in widths of the light */
    uint32_t n_at;                /* LINES: how many places, from 1 */
    double width;                 /* LINES: in widths of the light */
    float foreground[4];          /* bright part */
    float background[4];          /* dark part */
    struct renderer_image *image; /* IMAGE; must outlive the frame */
};

enum light_kind { LIGHT_RECTANGLE, LIGHT_PLANE, LIGHT_TUNNEL, LIGHT_SPHERE };
/* u and v are not parallel. Rectangle: x = centre + (s - 1/2) u + (t - 1/2) v, s and t in [0,1].
 * Plane: the same without an end, s and t of any value. Tunnel: u is the radius, v the axis. Sphere
 * at infinity: v is the axis, centre plays no part. */
struct light {
    enum light_kind kind;
    double centre[3], u[3], v[3];
    bool one_sided; /* seen only against u x v; else from both sides */
    struct pattern pattern;
};

enum line_family {
    LINES_REFLECTION,
    LINES_HIGHLIGHT,
    LINES_ISOPHOTE,
    LINES_ZEBRA,
    LINES_ENVIRONMENT,
};

/* Whose view the lines are computed for. */
enum line_eye_kind { LINE_EYE_CAMERA, LINE_EYE_POINT, LINE_EYE_DIRECTION };
struct lines {
    enum line_family family;
    bool has_direction;
    double direction[3]; /* ISOPHOTE: compared with N; ZEBRA, ENVIRONMENT: the axis */
    enum line_eye_kind eye_kind;
    double eye[3]; /* a place, or the direction of view; not zero */
};

/* What is seen: the limit surface, or as the conventional picture has it the polygons of the cage
 * subdivided `level` times (RANGE_LEVEL), vertices and normals on the limit surface and
 * interpolated between (mesh.h), or their edges. */
enum surface_kind { SURFACE_EXACT, SURFACE_POLYGON, SURFACE_WIREFRAME };
struct surface {
    enum surface_kind kind;
    uint32_t level; /* SURFACE_EXACT: 0 */
};

#endif
