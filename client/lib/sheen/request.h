/* A request: the scene, what is drawn of it, and in which form the frame comes. sheen.h has the
 * rules. */
#ifndef SHEEN_PUBLIC_REQUEST_H
#define SHEEN_PUBLIC_REQUEST_H

#include "base.h"
#include "scene.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

SHEEN_DECLARATIONS_BEGIN

/* The planes of a frame, as bits. Where a pixel's centre sees no surface, floats are NaN, except
 * ptex u and v and coverage, which are 0. */
enum sheen_plane {
    SHEEN_PLANE_COLOUR = 1,   /* uint8_t[4] R, G, B, A: sRGB, straight alpha */
    SHEEN_PLANE_POSITION = 2, /* float[3] */
    SHEEN_PLANE_NORMAL = 4,   /* float[3], unit length, by the faces' winding */
    SHEEN_PLANE_PTEX = 8,     /* uint32_t face (0xffffffff: none), float u, v */
    /* float s, t on the first light; NaN also where the ray misses it. */
    SHEEN_PLANE_LIGHT = 16,
    /* float k.min, k.max: principal curvatures in 1/unit, signed by the normal: negative where a
     * body is convex, seen from outside. */
    SHEEN_PLANE_CURVATURE = 32,
    /* float ds/dx, ds/dy, dt/dx, dt/dy: changes of s and t per pixel to the right (x) and down (y);
     * NaN where SHEEN_PLANE_LIGHT is. */
    SHEEN_PLANE_LIGHT_CHANGE = 64,
    /* float, 0 to 1: the share of the pixel that shows the surface; only for the exact surface with
     * antialiasing. */
    SHEEN_PLANE_COVERAGE = 128,
};
#define SHEEN_N_PLANES 8 /* number of planes in enum sheen_plane */

enum sheen_format {
    SHEEN_FORMAT_RAW,  /* decoded planes, sent uncompressed */
    SHEEN_FORMAT_ZSTD, /* decoded planes, sent with lossless compression */
    SHEEN_FORMAT_PNG,  /* a file with the colour plane */
    SHEEN_FORMAT_EXR,  /* a file with any planes */
    SHEEN_FORMAT_JPEG, /* a file with the colour plane, without alpha */
    SHEEN_FORMAT_TIFF, /* a file with the colour plane */
};

/* The surface to draw. Polygons are the cage subdivided surface_level times, with vertices and
 * normals of the limit surface, interpolated in between: the conventional picture, for comparison.
 * Wireframe draws the edges of those polygons. */
enum sheen_surface { SHEEN_SURFACE_EXACT, SHEEN_SURFACE_POLYGON, SHEEN_SURFACE_WIREFRAME };

/* What the colour plane shows: lines, or false colour with a legend. */
enum sheen_show_kind {
    SHEEN_SHOW_LINES,
    SHEEN_SHOW_CURVATURE, /* the principal curvature with the larger magnitude, 1/unit, signed */
    SHEEN_SHOW_GAUSSIAN,  /* Gaussian curvature, 1/unit^2 */
    SHEEN_SHOW_MEAN,      /* mean curvature, 1/unit */
    SHEEN_SHOW_NORMAL,    /* the unit normal as red, green, blue */
    SHEEN_SHOW_PTEX,      /* a colour for each Ptex face */
    SHEEN_SHOW_DRAFT,     /* 90 degrees - angle(normal, direction) */
};

struct sheen_show {
    enum sheen_show_kind kind;
    double direction[3]; /* draft: the direction of pull, not zero */
    /* The value at which the colours end, > 0; for draft at most 90. 0: chosen by the frame's
     * values, for draft 3. */
    double range;
    bool without_legend;
};

/* Subsampling of colour (Cb and Cr) in a JPEG file. */
enum sheen_jpeg_subsampling {
    SHEEN_JPEG_444, /* one sample for each pixel */
    SHEEN_JPEG_422, /* one sample for two pixels side by side */
    SHEEN_JPEG_420, /* one sample for two by two pixels */
};

/* The priority of a request among others. */
enum sheen_class {
    SHEEN_CLASS_STILL, /* a person waits for the picture */
    /* A person drags: served first, and only the newest request of a view counts. */
    SHEEN_CLASS_INTERACTIVE,
    SHEEN_CLASS_BATCH, /* nobody waits; never replaced by a newer request */
};

/* A frame that shows a part of a picture: the place of the frame's top left corner in the picture,
 * and the picture's size, for which the camera is. The part must be inside. All 0: the frame is the
 * whole picture. */
struct sheen_window {
    double x_px, y_px;            /* 0 to 65535; not only whole numbers */
    uint32_t width_px, height_px; /* 1 to 65536; the device's limits do not matter */
};

struct sheen_request {
    size_t size;
    uint8_t model_id[SHEEN_ID_BYTES]; /* id of an uploaded model */
    uint32_t width_px, height_px;     /* 1 to sheen_server.max_width_px, max_height_px */
    struct sheen_camera camera;
    struct sheen_lines lines;
    uint32_t n_lights; /* 1 to SHEEN_MAX_LIGHTS; the first light lies over the second, and so on */
    struct sheen_light lights[SHEEN_MAX_LIGHTS];
    bool has_miss, has_empty, has_base; /* false: the daemon's default colour */
    /* Where the ray meets no light; sRGB, straight alpha, 0 to 1. */
    float miss[4];
    float empty[4]; /* where a pixel shows no surface */
    float base[4];  /* the surface itself, visible where a pattern's opacity is below 1 */
    /* One sample of surface and pattern for each pixel, for comparison. Includes `aliased`. */
    bool unfiltered;
    /* One sample of the surface for each pixel: edges are not antialiased and there is no coverage
     * plane. Patterns are still averaged over the pixel. SHEEN_BAD_ARGUMENT with an older
     * daemon. */
    bool aliased;
    struct sheen_show show; /* not with SHEEN_SURFACE_WIREFRAME */
    uint32_t planes;        /* bits of enum sheen_plane */
    enum sheen_format format;
    uint32_t jpeg_quality;                        /* SHEEN_FORMAT_JPEG: 1 to 100; 0: 95 */
    enum sheen_jpeg_subsampling jpeg_subsampling; /* SHEEN_FORMAT_JPEG */
    enum sheen_surface surface;
    uint32_t surface_level; /* polygons and wireframe: 0 to 6; exact: 0 */
    enum sheen_class request_class;
    /* True: a newer still request of the same view may replace this one. Interactive requests
     * always belong to a view; without has_view it is view 0. */
    bool has_view;
    uint32_t view; /* a number that the program chooses for each of its pictures */
    /* The frame must begin to be drawn within this time after the daemon has read the request; at
     * most 3600000; 0: no deadline. */
    uint32_t deadline_ms;
    /* SHEEN_FORMAT_RAW and _ZSTD: the planes are not decoded but returned in frame.data as they
     * were sent (protocol/README.md, chapter 5), for programs that store them or pass them on. */
    bool undecoded;
    /* For a part of a picture. At whole numbers its planes are those of the picture: on the native
     * device bit by bit, on others except for rounding. SHEEN_BAD_ARGUMENT with an older daemon. */
    struct sheen_window window;
};
#define SHEEN_REQUEST_DEFAULTS                                                                     \
    ((struct sheen_request){.size = sizeof(struct sheen_request),                                  \
                            .width_px = 1280,                                                      \
                            .height_px = 720,                                                      \
                            .camera = {.up = {0, 0, 1}, .fov_deg = 35},                            \
                            .n_lights = 1,                                                         \
                            .lights = {{.pattern = SHEEN_PATTERN_DEFAULTS}},                       \
                            .planes = SHEEN_PLANE_COLOUR,                                          \
                            .format = SHEEN_FORMAT_PNG})
/* Writes the defaults into a struct of `size` bytes. */
void sheen_request_init(struct sheen_request *request, size_t size);

static inline struct sheen_request sheen_request_defaults(void)
{
    struct sheen_request request;
    sheen_request_init(&request, sizeof(request));
    return request;
}

SHEEN_DECLARATIONS_END

#endif
