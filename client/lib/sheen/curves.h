/* Computed numbers: lines as curves. sheen.h has the rules. */
#ifndef SHEEN_PUBLIC_CURVES_H
#define SHEEN_PUBLIC_CURVES_H

#include "base.h"
#include "request.h"
#include "scene.h"
#include "session.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

SHEEN_DECLARATIONS_BEGIN

struct sheen_curve_options {
    size_t size;
    /* Greatest distance of a curve from its chords, units of the file: at least 1e-9 of the
     * diagonal of the model's box, at most 1e30; 0: 1e-5 of the diagonal. */
    double tolerance;
    /* Places of lines on each light, as `at` of a pattern of lines: at most SHEEN_MAX_CURVE_PLACES,
     * each from -1e6 to 1e6; 0: those of the lights' patterns (of stripes and lattices the middle
     * of each bright stripe). */
    uint32_t n_at;
    const double *at;
    bool silhouettes; /* those of the line eye, instead of lines */
};
#define SHEEN_CURVE_OPTIONS_DEFAULTS                                                               \
    ((struct sheen_curve_options){.size = sizeof(struct sheen_curve_options)})
#define SHEEN_MAX_CURVE_PLACES 256

/* A point of a curve. */
struct sheen_curve_point {
    uint32_t face; /* Ptex face */
    double uv[2];
    double position[3], normal[3]; /* normal: unit length */
    double along[3];               /* unit tangent of the curve; zero: it has none there */
    double residual; /* place on the light less the line's; NAN: no light is met exactly there */
    double length;   /* from the curve's first point, along the chords; units */
};

struct sheen_curve {
    uint32_t light; /* from 0 */
    uint32_t line;  /* number of the line among those of all lights, from 0 */
    double place;   /* on the light; NAN: a silhouette */
    bool is_closed; /* the last point is followed by the first */
    size_t n_points;
    const struct sheen_curve_point *points;
    double length;
};

enum sheen_curve_mark_kind {
    SHEEN_CURVE_SINGULAR, /* curves of a line meet there, or a curve is one point */
    SHEEN_CURVE_FLAT,     /* the line covers a part of the surface */
};

/* A place where the course of a line was not decided. */
struct sheen_curve_mark {
    enum sheen_curve_mark_kind kind;
    uint32_t light, line, face;
    double uv[2], position[3], normal[3];
};

/* Initialise it with SHEEN_CURVES_DEFAULTS, pass it to any number of calls, and free it by
 * sheen_curves_finish(). */
struct sheen_curves {
    size_t size;
    struct sheen_curves_memory *memory; /* private to the library */
    uint32_t n_curves, n_marks;
    uint64_t n_points;                /* of all curves */
    const struct sheen_curve *curves; /* in the order of lines */
    const struct sheen_curve_mark *marks;
    double tolerance, diagonal; /* units: as used; of the model's box */
    /* The camera, lines and lights that were used. */
    struct sheen_camera camera;
    struct sheen_lines lines;
    uint32_t n_lights;
    struct sheen_light lights[SHEEN_MAX_LIGHTS];
    uint64_t total_us; /* from the request's last byte to the answer's first */
    char server[32];   /* the daemon's version */
};
#define SHEEN_CURVES_DEFAULTS ((struct sheen_curves){.size = sizeof(struct sheen_curves)})

/* Traces the lines of request's lights on the surface as curves, none of which is lost. Of the
 * request, model, camera, lines, lights and deadline_ms count. `options` and `progress` may be
 * NULL. protocol/README.md, chapter 10, and server/curves/README.md say how curves are found.
 * SHEEN_BAD_ARGUMENT while requests are in flight, with a daemon that is too old, or if `at` is
 * given for silhouettes. SHEEN_BAD_REQUEST if the tolerance is too small for the model, if there
 * are more than 1024 lines, or if the lines of a pattern cannot be traced because of its rotation.
 * If the request was not sent (SHEEN_BAD_ARGUMENT, or a session that had failed before) *curves is
 * unchanged; after another failure it is empty. */
enum sheen_status sheen_trace_lines(struct sheen_session *session,
                                    const struct sheen_request *request,
                                    const struct sheen_curve_options *options,
                                    const struct sheen_progress *progress,
                                    struct sheen_curves *curves, struct sheen_error *error);

/* Frees the memory of a result and zeroes it except for its size. NULL and a zeroed one are
 * safe. */
void sheen_curves_finish(struct sheen_curves *curves);

static inline struct sheen_curve_options sheen_curve_options_defaults(void)
{
    struct sheen_curve_options options;
    sheen_struct_init(&options, sizeof(options));
    return options;
}

static inline struct sheen_curves sheen_curves_defaults(void)
{
    struct sheen_curves curves;
    sheen_struct_init(&curves, sizeof(curves));
    return curves;
}

SHEEN_DECLARATIONS_END

#endif
