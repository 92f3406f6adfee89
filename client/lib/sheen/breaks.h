/* Computed numbers: where lines break. sheen.h has the rules. */
#ifndef SHEEN_PUBLIC_BREAKS_H
#define SHEEN_PUBLIC_BREAKS_H

#include "base.h"
#include "request.h"
#include "scene.h"
#include "session.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

SHEEN_DECLARATIONS_BEGIN

/* An edge is out of tolerance where it exceeds one of these; 0: the default. Ranges: gap above 0 to
 * 1e30; angle_deg above 0 to 180; curvature_percent above 0 to 200. */
struct sheen_break_limits {
    size_t size;
    double gap;       /* units of the file; default: 1e-5 of the diagonal of the model's box */
    double angle_deg; /* between the normals of both sides; default: 0.1 */
    double curvature_percent; /* jump of the curvature; default: 10 */
};
#define SHEEN_BREAK_LIMITS_DEFAULTS                                                                \
    ((struct sheen_break_limits){.size = sizeof(struct sheen_break_limits)})

enum sheen_break_kind {
    SHEEN_BREAK_CREASE,    /* an infinitely sharp crease */
    SHEEN_BREAK_SEMISHARP, /* a crease of finite sharpness: smooth, and never out of tolerance */
    /* Two border edges that lie together, because the file does not join their vertices or because
     * an edge has more than two faces; or a common curve of two patches across which only the
     * curvature jumps. */
    SHEEN_BREAK_JOINT,
};

/* What is measured at an edge. */
enum sheen_break_measure {
    SHEEN_BREAK_GAP,       /* distance of both sides, units */
    SHEEN_BREAK_ANGLE,     /* between the normals, degrees; of a semi-sharp crease: the turn of the
                            * normal within its rounding */
    SHEEN_BREAK_CURVATURE, /* jump of the curvature across the edge, 1/unit */
    SHEEN_BREAK_PERCENT,   /* the same in percent of the mean of both curvatures, 0 to 200 */
    SHEEN_BREAK_KINK,      /* of a light's lines, degrees */
    SHEEN_BREAK_JUMP,      /* of a light's lines, spacings */
};
#define SHEEN_N_BREAK_MEASURES 6

/* A measure at its worst place. value is NAN if it has none anywhere on the edge. */
struct sheen_break_worst {
    double value, position[3];
    double uv[2]; /* on faces[0] */
};

struct sheen_break_edge {
    enum sheen_break_kind kind;
    uint32_t faces[2];               /* Ptex faces */
    uint32_t edges[2];               /* 0 to 3, of each face */
    uint32_t over;                   /* bit i: measure i exceeds its limit */
    bool has_dart;                   /* the crease ends at one of its vertices */
    uint32_t kink_light, jump_light; /* lights for which kink and jump are the worst, from 0 */
    double length, out_length;       /* units: of the edge; of its part out of tolerance */
    double shift; /* units: the jump of the lines, as a length on the surface; NAN: unknown */
    struct sheen_break_worst worst[SHEEN_N_BREAK_MEASURES];
};

/* The curvature around an extraordinary vertex, where it need not have a limit. */
struct sheen_break_vertex {
    uint32_t face, corner;
    uint32_t n_faces;           /* around it, or between two creases or borders; at most 65535 */
    bool is_inside;             /* faces all around it */
    double radius;              /* units: distance of the places of measurement, in the mean */
    double k_least, k_greatest; /* principal curvatures, 1/unit, signed */
    double position[3];
};

/* Initialise it with SHEEN_BREAKS_DEFAULTS, pass it to any number of calls, and free it by
 * sheen_breaks_finish(). */
struct sheen_breaks {
    size_t size;
    struct sheen_breaks_memory *memory; /* private to the library */
    uint32_t n_edges, n_vertices;
    const struct sheen_break_edge *edges; /* the worst one first */
    const struct sheen_break_vertex *vertices;
    uint32_t n_out; /* edges out of tolerance: the first ones */
    uint32_t n_creases, n_semisharp, n_joints;
    uint32_t n_borders;                                /* edges with a face on one side */
    double gap, angle_deg, curvature_percent;          /* limits that were used */
    double creases_length, borders_length, out_length; /* units */
    double diagonal;                                   /* of the model's box, units */
    /* The camera, lines and lights that were used. */
    struct sheen_camera camera;
    struct sheen_lines lines;
    uint32_t n_lights;
    struct sheen_light lights[SHEEN_MAX_LIGHTS];
    uint64_t total_us; /* from the request's last byte to the answer's first */
    char server[32];   /* the daemon's version */
};
#define SHEEN_BREAKS_DEFAULTS ((struct sheen_breaks){.size = sizeof(struct sheen_breaks)})

/* Finds where the lines of request's model break, in double precision on the surface itself. Of the
 * request, model, camera, lines, lights and deadline_ms count; the image of an image pattern need
 * not be uploaded. `limits` and `progress` may be NULL. protocol/README.md, chapter 10, and
 * server/curves/README.md define all measures. SHEEN_BAD_ARGUMENT while requests are in flight, or
 * with a daemon that is too old. If the request was not sent (SHEEN_BAD_ARGUMENT, or a session that
 * had failed before) *breaks is unchanged; after another failure it is empty. */
enum sheen_status sheen_find_breaks(struct sheen_session *session,
                                    const struct sheen_request *request,
                                    const struct sheen_break_limits *limits,
                                    const struct sheen_progress *progress,
                                    struct sheen_breaks *breaks, struct sheen_error *error);

/* Frees the memory of a result and zeroes it except for its size. NULL and a zeroed one are
 * safe. */
void sheen_breaks_finish(struct sheen_breaks *breaks);

static inline struct sheen_break_limits sheen_break_limits_defaults(void)
{
    struct sheen_break_limits limits;
    sheen_struct_init(&limits, sizeof(limits));
    return limits;
}

static inline struct sheen_breaks sheen_breaks_defaults(void)
{
    struct sheen_breaks breaks;
    sheen_struct_init(&breaks, sizeof(breaks));
    return breaks;
}

SHEEN_DECLARATIONS_END

#endif
