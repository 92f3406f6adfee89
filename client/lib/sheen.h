/* libsheen: exact reflection lines from a sheend, for programs in C11 and C++17.
 *
 *     struct sheen_error error;
 *     struct sheen_connect_options options = SHEEN_CONNECT_DEFAULTS; // a private daemon
 *     struct sheen_request request = SHEEN_REQUEST_DEFAULTS;         // 1280x720, a PNG file
 *     struct sheen_frame frame = SHEEN_FRAME_DEFAULTS;
 *     struct sheen_session *session = NULL;
 *
 *     sheen_file_id(bytes, n_bytes, request.model_id);
 *     if (sheen_connect(&session, &options, &error) ||
 *         sheen_upload(session, SHEEN_FILE_MODEL, request.model_id, bytes, n_bytes, "hood.obj",
 *                      NULL, &error) ||
 *         sheen_render(session, &request, NULL, &frame, &error))
 *         fprintf(stderr, "%s\n", error.text);
 *     else
 *         fwrite(frame.data, 1, frame.data_bytes, out);
 *     sheen_frame_finish(&frame);
 *     sheen_close(session);
 *
 * In C++ the defaults are functions: `sheen_request request = sheen_request_defaults();`.
 *
 * Waiting: a call blocks until it is done, has failed, or no byte has moved for `timeout_ms`. A
 * program with an event loop of its own waits on sheen_descriptor() and takes frames by
 * sheen_try_receive().
 *
 * Failure: functions return SHEEN_OK (0) or a status, and then fill *error, which may be NULL.
 * After a status for which sheen_status_is_fatal() is true the session takes nothing but
 * sheen_close(); after any other it goes on working. Arguments are checked: a NULL that is not
 * allowed, NaN and values out of range cost SHEEN_BAD_ARGUMENT, and nothing is sent.
 *
 * Growth: a later version of the library with the same soname may add members at the end of the
 * structs that begin with `size`, and adds none to the others. `size` is the struct's sizeof in the
 * program, as the defaults set it, and 16 at least. The library touches no byte beyond it.
 *   - A program that was compiled with an older sheen.h: the members that it lacks have their
 *     defaults in what it gives, and are not written in what it gets.
 *   - A program that was compiled with a newer sheen.h than the library: the members that the
 *     library lacks must be zero in what the program gives (else SHEEN_BAD_ARGUMENT), and are zero
 *     in what it gets.
 * Enumerators keep their numbers.
 *
 * Thread: a session belongs to one thread at a time; different sessions are independent. No SIGPIPE
 * is raised, no signal handler installed, no global state kept.
 *
 * Units: pixels `_px`, microseconds `_us`, milliseconds `_ms`, degrees `_deg`; coordinates are the
 * model file's own units, right-handed; pixel (0,0) is top left. */
#ifndef SHEEN_H
#define SHEEN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif
#if defined(__GNUC__)
#pragma GCC visibility push(default)
#endif

#define SHEEN_ID_BYTES 32      /* SHA-256 of a file's bytes */
#define SHEEN_N_PLANES 8       /* how many enumerators enum sheen_plane has */
#define SHEEN_MAX_IN_FLIGHT 64 /* requests sent and not yet received: the most any daemon takes */

enum sheen_status {
    SHEEN_OK,
    SHEEN_BAD_ARGUMENT,  /* refused here, nothing was sent               exit code 2 */
    SHEEN_BAD_REQUEST,   /* refused by the daemon: out of its range      exit code 2 */
    SHEEN_BAD_MODEL,     /* the cage is bad or not supported             exit code 3 */
    SHEEN_BAD_IMAGE,     /* an image is bad or cannot be written         exit code 3 */
    SHEEN_TOO_BIG,       /* the file is over the daemon's limit          exit code 3 */
    SHEEN_UNKNOWN_MODEL, /* the daemon lacks the file: upload it (again) exit code 4 */
    SHEEN_OVERLOADED,    /* the daemon is full: try later                exit code 4 */
    SHEEN_SUPERSEDED,    /* a newer request of its view took its place   exit code 4 */
    SHEEN_CANCELLED,     /* by sheen_cancel()                            exit code 4 */
    SHEEN_LATE,          /* not drawn within its deadline                exit code 4 */
    SHEEN_GPU_LOST,      /* the daemon's GPU, again and again; ask later exit code 4 */
    SHEEN_SHUTTING_DOWN, /* fatal                                        exit code 4 */
    SHEEN_NO_SERVER,     /* fatal: cannot connect, or start a daemon     exit code 4 */
    SHEEN_LOST_SERVER,   /* fatal: the connection broke                  exit code 4 */
    SHEEN_TIMEOUT,       /* fatal: nothing moved for timeout_ms          exit code 4 */
    SHEEN_BAD_PEER,      /* fatal: the peer broke the protocol           exit code 4 */
    SHEEN_BAD_VERSION,   /* fatal: the peer speaks another major version exit code 4 */
    SHEEN_NO_MEMORY,     /* fatal: memory is short here                  exit code 4 */
    SHEEN_DEVICE_FAILED, /* EGL or the GPU failed, or there is none      exit code 5 */
    SHEEN_AGAIN,         /* sheen_try_receive(): no answer is whole yet  exit code 4 */
};

struct sheen_error {
    enum sheen_status status;
    char text[640]; /* one line, UTF-8, no newline: what, where, what to do */
};

/* The library's version and the wire's: "0.1.0, protocol 1.3". Pure. */
const char *sheen_version(void);

/* The exit code that the `sheen` command ends with: 0, 2, 3, 4 or 5. Pure, as the next one. */
int sheen_status_exit_code(enum sheen_status status);
bool sheen_status_is_fatal(enum sheen_status status);

/* Zeroes a struct that begins with `size`, of `size` bytes, and sets its size: the defaults of what
 * the library fills in. For languages without the macros below.
 * Does nothing when size is below 16. */
void sheen_struct_init(void *sized_struct, size_t size);

/* ---- sessions ---- */

struct sheen_session;

struct sheen_connect_options {
    size_t size;
    const char *address; /* unix:PATH, tcp:HOST:PORT or tls:HOST:PORT; NULL: a private daemon */
    /* Private daemon: "auto" (NULL), a GPU, else processors; "software" or "native", processors; or
     * the number of an EGL device. */
    const char *device;
    /* Private daemon: what files, tables and frames may take together, 4 MiB or more; 0: half of
     * the memory that this machine has, or its control group may take. */
    uint64_t memory_budget_bytes;
    uint32_t timeout_ms;         /* with no byte moved; 0: for ever */
    uint32_t connect_timeout_ms; /* the same, until the daemon has greeted; 0: timeout_ms */
    /* A balancer picks a node by it: the id of the model that will be asked for, and where that is
     * a file at the server, sheen_file_id() of the text "server:" NAME. Zeros: any node. */
    uint8_t model_id[SHEEN_ID_BYTES];
    /* For tls: addresses; PEM files. The daemon's certificate is checked against `ca`, NULL: what
     * the system trusts. The daemon may want cert and key, or a token, of the client. */
    const char *ca, *cert, *key;
    const char *token; /* sent over TLS only */
    bool share;        /* whoever knows its SHA-256 may use what this session uploads */
    /* Private daemon's native device: "auto" (NULL), "v2", "v3" or "v4" of x86-64's instructions,
     * and how many threads draw, 1 to 64; 0: one for each processor that it may use. */
    const char *native_isa;
    uint32_t native_threads;
};
#define SHEEN_CONNECT_DEFAULTS                                                                     \
    ((struct sheen_connect_options){.size = sizeof(struct sheen_connect_options),                  \
                                    .timeout_ms = 300000})
/* Writes the defaults into the first `size` bytes. */
void sheen_connect_options_init(struct sheen_connect_options *options, size_t size);

/* Connects and shakes hands. On success *session is the caller's, to be given back with
 * sheen_close(); on failure it is NULL: SHEEN_NO_SERVER, SHEEN_LOST_SERVER (it went away, or the
 * private daemon ended at once), SHEEN_BAD_PEER, SHEEN_BAD_VERSION, SHEEN_TIMEOUT,
 * SHEEN_OVERLOADED, SHEEN_DEVICE_FAILED (a private daemon found no device), SHEEN_BAD_ARGUMENT
 * (also a certificate or key that cannot be read).
 *
 * A private daemon is a child process on a socket pair: $SHEEN_DAEMON, else `sheend` beside this
 * program, else `sheend` on the PATH. It ends with the session. It inherits no file but its socket,
 * and its standard error is kept to explain its death. */
enum sheen_status sheen_connect(struct sheen_session **session,
                                const struct sheen_connect_options *options,
                                struct sheen_error *error);

/* Ends the session and its private daemon, and reaps it. NULL is safe. */
void sheen_close(struct sheen_session *session);

/* What the daemon said of itself. Strings live as long as the session. */
struct sheen_server {
    size_t size;
    const char *version;
    const char *device, *driver;
    bool software;
    uint32_t max_width_px, max_height_px;
    uint64_t max_upload_bytes;
    uint32_t max_in_flight; /* requests sent and not yet received, 1 to SHEEN_MAX_IN_FLIGHT */
};
#define SHEEN_SERVER_DEFAULTS ((struct sheen_server){.size = sizeof(struct sheen_server)})

/* Sends nothing. SHEEN_BAD_ARGUMENT alone. */
enum sheen_status sheen_get_server(const struct sheen_session *session, struct sheen_server *server,
                                   struct sheen_error *error);

/* The session's socket, to wait on with poll() beside others; it stays the library's, which alone
 * reads, writes and closes it. *events gets what to wait for before the next sheen_try_receive():
 * POLLIN, or POLLOUT while TLS must write first. -1 for a session that is NULL or has failed;
 * *events is then 0. */
int sheen_descriptor(const struct sheen_session *session, short *events);

/* Called now and then by the calls that take it: for uploads with stage "upload" and bytes, and
 * with whatever stage the daemon reports ("tables" and faces). May be called with done == total.
 * Must not call the session back. */
struct sheen_progress {
    void (*report)(void *context, const char *stage, uint64_t done, uint64_t total);
    void *context;
};

/* ---- files ---- */

enum sheen_file_kind { SHEEN_FILE_MODEL, SHEEN_FILE_IMAGE };

/* The identity of a file. False only when libcrypto fails. */
bool sheen_file_id(const void *bytes, size_t n_bytes, uint8_t id[SHEEN_ID_BYTES]);

/* Makes the daemon have a file: bytes travel only if it lacks them, from where a broken upload
 * ended. `id` is what sheen_file_id() says; the daemon checks it. `name` is the file's name,
 * folders are dropped; its ending tells a model's format; an OBJ file with the line "t weld 0/0/0"
 * has its equal positions joined. progress may be NULL. Not while requests are in flight
 * (SHEEN_BAD_ARGUMENT). SHEEN_TOO_BIG, SHEEN_BAD_MODEL, SHEEN_BAD_IMAGE when the daemon refuses
 * it. */
enum sheen_status sheen_upload(struct sheen_session *session, enum sheen_file_kind kind,
                               const uint8_t id[SHEEN_ID_BYTES], const void *bytes, size_t n_bytes,
                               const char *name, const struct sheen_progress *progress,
                               struct sheen_error *error);

/* The id of a model file that lies at the daemon, below its --models: `name` is its path there.
 * Builds its tables if that has not happened. SHEEN_BAD_MODEL when there is none or it is bad,
 * SHEEN_BAD_REQUEST when the daemon has no files of its own. */
enum sheen_status sheen_find_model(struct sheen_session *session, const char *name,
                                   const struct sheen_progress *progress,
                                   uint8_t id[SHEEN_ID_BYTES], struct sheen_error *error);

/* What a file has that it is probably not meant to have; its warning says so in words. */
enum sheen_finding_kind {
    SHEEN_FINDING_REPEATED_CORNER, /* faces that lost a corner which repeats its neighbour */
    SHEEN_FINDING_FEW_CORNERS,     /* faces passed over: fewer than three different corners */
    SHEEN_FINDING_KEYHOLE, /* faces passed over: a vertex at corners that are no neighbours */
    SHEEN_FINDING_CREASE_WITHOUT_EDGE,   /* tags passed over */
    SHEEN_FINDING_CORNER_WITHOUT_VERTEX, /* tags passed over */
    SHEEN_FINDING_HOLE_WITHOUT_FACE,     /* tags passed over */
    SHEEN_FINDING_UNWELDED,  /* repeated positions, where no face shares a vertex with another */
    SHEEN_FINDING_TRIANGLES, /* faces that are plain triangles */
    SHEEN_FINDING_WOUND_AGAINST, /* edges that two faces run along in one direction */
    SHEEN_FINDING_FACE_TWICE,    /* faces that are there again */
    SHEEN_FINDING_INSIDE_OUT,    /* closed bodies whose faces turn inwards */
    SHEEN_FINDING_OTHER,         /* a kind that only a later daemon knows */
};

struct sheen_finding {
    enum sheen_finding_kind kind;
    uint32_t count; /* of what the kind says, from 1 */
    uint32_t line;  /* of the file, from 1, where the first is; 0: none */
    bool has_face;  /* where a file has no lines */
    uint32_t face;  /* the first, from 0 */
};

struct sheen_valence {
    uint32_t valence, count;
};

#define SHEEN_MAX_FINDINGS 16
#define SHEEN_MAX_VALENCES 64
struct sheen_model_info {
    size_t size;
    uint8_t id[SHEEN_ID_BYTES];
    char name[256];
    uint64_t file_bytes;
    uint32_t vertices, faces, triangles, quads, ngons; /* of the cage */
    uint32_t ptex_faces, boundary_edges;
    uint32_t n_valences; /* entries below; the last one sums the rest when there are more */
    struct sheen_valence
        extraordinary[SHEEN_MAX_VALENCES]; /* interior vertices with other than 4 edges */
    uint32_t boundary_extraordinary;       /* boundary vertices with other than 2 faces */
    uint32_t sharp_edges, semisharp_edges; /* creases: infinitely sharp, and others */
    uint32_t sharp_vertices;               /* with sharpness of their own, infinite or not */
    uint32_t holes;                        /* faces */
    uint32_t nonmanifold_edges;            /* in 3 faces and more, or run in one direction by 2 */
    uint32_t nonmanifold_vertices;         /* whose faces are not one fan */
    uint32_t regular_patches, corner_patches, strip_patches, split_nodes, hole_nodes;
    uint64_t table_bytes;                 /* on the GPU; of the native device in main memory */
    uint64_t regular_bytes, corner_bytes; /* of one such patch */
    uint64_t tables_us;                   /* reading, building and uploading took this long */
    double box_min[3], box_max[3];
    char warnings[4096]; /* lines; "" when there are none */
    uint32_t n_findings; /* at most one of each kind that is known here */
    struct sheen_finding findings[SHEEN_MAX_FINDINGS];
};
#define SHEEN_MODEL_INFO_DEFAULTS                                                                  \
    ((struct sheen_model_info){.size = sizeof(struct sheen_model_info)})

/* What an uploaded model is and costs; builds its tables if that has not happened. */
enum sheen_status sheen_query_model(struct sheen_session *session, const uint8_t id[SHEEN_ID_BYTES],
                                    const struct sheen_progress *progress,
                                    struct sheen_model_info *info, struct sheen_error *error);

/* ---- frames ---- */

/* Bits. Floats are NaN where nothing is hit, but ptex u and v and coverage, which are 0. */
enum sheen_plane {
    SHEEN_PLANE_COLOUR = 1,     /* uint8_t[4] RGBA as displayed (sRGB), straight alpha */
    SHEEN_PLANE_POSITION = 2,   /* float[3] */
    SHEEN_PLANE_NORMAL = 4,     /* float[3], unit, along the face winding */
    SHEEN_PLANE_PTEX = 8,       /* uint32_t face (0xffffffff: none), float u, float v */
    SHEEN_PLANE_LIGHT = 16,     /* float s, t on the first light; NaN where it is not met, too */
    SHEEN_PLANE_CURVATURE = 32, /* float k.min, k.max in 1/unit, signed against the normal: below
                                   0 where a body seen from outside is convex */
    SHEEN_PLANE_LIGHT_CHANGE =
        64,                     /* float ds/dx ds/dy dt/dx dt/dy by a pixel right and down; NaN as
                                      SHEEN_PLANE_LIGHT is */
    SHEEN_PLANE_COVERAGE = 128, /* float share of the pixel that shows surface, 0 where none is; for
                                   the exact surface with antialiasing only */
};

enum sheen_format {
    SHEEN_FORMAT_RAW,  /* planes, sent as they are */
    SHEEN_FORMAT_ZSTD, /* planes, sent compressed, lossless */
    SHEEN_FORMAT_PNG,  /* an encoded file, colour only */
    SHEEN_FORMAT_EXR,  /* an encoded file, any planes */
    SHEEN_FORMAT_JPEG,
    SHEEN_FORMAT_TIFF,
};

enum sheen_projection {
    SHEEN_PROJECTION_AUTO, /* all as the daemon frames the model; the rest is ignored */
    SHEEN_PROJECTION_PERSPECTIVE,
    SHEEN_PROJECTION_ORTHOGRAPHIC,
};

/* Who says which way a model's up is. */
enum sheen_up_source {
    SHEEN_UP_GIVEN,   /* the request */
    SHEEN_UP_FILE,    /* the model's file: glTF is Y up */
    SHEEN_UP_GUESSED, /* nobody: z, or y where the model is thinner in y by more than 1 % */
    SHEEN_UP_UNKNOWN, /* the daemon is too old to say */
};

/* From where a camera that frames the model looks: protocol/README.md, chapter 4. */
enum sheen_view {
    SHEEN_VIEW_AROUND, /* from above the front right, the longer side across the picture */
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
    bool auto_view, auto_up;  /* eye and target, or up, are the daemon's, which frames the model */
    bool has_target;          /* with auto_view: the daemon's eye looks at target */
    enum sheen_view view;     /* with auto_view */
    double zoom;              /* magnification from the same eye, 1 to 1e6; 0: none */
    double zoom_at[2];        /* at this place of the picture, from its left and top, 0 to 1 */
    double eye[3], target[3]; /* not the same point */
    double up[3];             /* not along the line of sight; need not be perpendicular */
    double fov_deg;           /* perspective: vertical, 1e-6 to 179 */
    double ortho_height;      /* orthographic: units from top to bottom, > 0 */
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
    SHEEN_PATTERN_DISTANCE, /* bands by the length of the ray; not for lights at infinity */
};

/* What a light shows; formulas in shaders/README.md of the sources. */
struct sheen_pattern {
    enum sheen_pattern_kind kind;
    double count;                      /* periods over the light's width, (0, 100000] */
    double period;                     /* in the light's units, > 0; 0: by count */
    double duty;                       /* bright part of a period, [0, 1] */
    double rotation_deg, offset;       /* offset in periods */
    double soft;                       /* share of a period (SHEEN_PATTERN_LINES: of the width) that
                                           each edge takes, [0, 1] */
    double opacity;                    /* over the shaded base, [0, 1] */
    uint32_t n_at;                     /* SHEEN_PATTERN_LINES: 1 to SHEEN_MAX_LINES, else 0 */
    double at[SHEEN_MAX_LINES], width; /* places and width, in widths of the light */
    bool has_colours;                  /* false: the daemon's (white on black) */
    float foreground[4], background[4]; /* RGBA in [0, 1], as displayed */
    uint8_t image_id[SHEEN_ID_BYTES];   /* SHEEN_PATTERN_IMAGE: an uploaded image */
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

/* Rectangle and plane: x = centre + (s - 1/2) u + (t - 1/2) v, for the rectangle s and t in [0, 1].
 * Tunnel: u is the radius, v along the axis through centre. Sphere at infinity: v is its axis. */
struct sheen_light {
    enum sheen_light_kind kind;
    bool has_kind;  /* false, and not placed: a tunnel about the model; kind is ignored */
    bool is_placed; /* false: as the daemon places it about the model; centre, u, v are ignored */
    bool one_sided; /* rectangle and plane: seen only against u x v */
    double centre[3], u[3], v[3];
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
    /* Isophotes: what the normal is compared with, left out: the view. Zebra and environment: the
     * axis. */
    bool has_direction;
    double direction[3];          /* not zero */
    enum sheen_line_eye eye_kind; /* whose view the lines are computed for */
    double eye[3];                /* a place, or a direction of view that is not zero */
};

/* The polygons are those of the cage subdivided surface_level times, with vertices and normals on
 * the limit surface, interpolated between: the conventional picture, for comparison. */
enum sheen_surface { SHEEN_SURFACE_EXACT, SHEEN_SURFACE_POLYGON, SHEEN_SURFACE_WIREFRAME };

/* False colour with a legend, instead of lines. */
enum sheen_show_kind {
    SHEEN_SHOW_LINES,
    SHEEN_SHOW_CURVATURE, /* the principal curvature of larger magnitude, 1/unit, signed */
    SHEEN_SHOW_GAUSSIAN,  /* 1/unit^2 */
    SHEEN_SHOW_MEAN,      /* 1/unit */
    SHEEN_SHOW_NORMAL,
    SHEEN_SHOW_PTEX,
    SHEEN_SHOW_DRAFT, /* 90 degrees - angle(normal, direction) */
};

struct sheen_show {
    enum sheen_show_kind kind;
    double direction[3]; /* draft: the pull direction, not zero */
    /* Where the colours end, > 0, of draft at most 90; 0: as the frame's values want it, of draft
     * 3. */
    double range;
    bool without_legend;
};

/* The least or greatest value that a frame of false colour shows at the centre of a pixel. */
struct sheen_extreme {
    bool has_value; /* false: no pixel shows one, or the daemon is too old to say */
    double value;
    bool has_place;      /* false: the value is the same everywhere */
    uint32_t x_px, y_px; /* the first such pixel, from the top and then from the left */
    double position[3];
    bool has_ptex; /* the frame has that plane */
    uint32_t face;
    double u, v;
};

/* Of a JPEG file's colour. */
enum sheen_jpeg_subsampling {
    SHEEN_JPEG_444, /* one sample for each pixel */
    SHEEN_JPEG_422, /* for two side by side */
    SHEEN_JPEG_420, /* for two by two */
};

/* How the daemon treats a request when it has many. */
enum sheen_class {
    SHEEN_CLASS_STILL,       /* somebody waits for it */
    SHEEN_CLASS_INTERACTIVE, /* somebody drags: first, and only the newest of a view counts */
    SHEEN_CLASS_BATCH,       /* nobody waits; never replaced */
};

struct sheen_request {
    size_t size;
    uint8_t model_id[SHEEN_ID_BYTES]; /* an uploaded model */
    uint32_t width_px, height_px;     /* 1 to the daemon's limit */
    struct sheen_camera camera;
    struct sheen_lines lines;
    uint32_t n_lights; /* 1 to SHEEN_MAX_LIGHTS; the first lies over the second */
    struct sheen_light lights[SHEEN_MAX_LIGHTS];
    bool has_miss, has_empty, has_base; /* false: the daemon's colours */
    float miss[4];                      /* where no light is met, RGBA in [0, 1] */
    float empty[4];                     /* where no surface is hit */
    float base[4];          /* of the surface, seen where a pattern's opacity is below 1 */
    bool unfiltered;        /* one sample a pixel, of surface and pattern; `aliased` adds nothing */
    bool aliased;           /* one sample of the surface a pixel: no shares at edges, no coverage;
                               patterns stay averaged. SHEEN_BAD_ARGUMENT with an older daemon */
    struct sheen_show show; /* in the colour plane; not with SHEEN_SURFACE_WIREFRAME */
    uint32_t planes;        /* enum sheen_plane bits */
    enum sheen_format format;
    uint32_t jpeg_quality; /* SHEEN_FORMAT_JPEG: 1 to 100; 0: the daemon's, 95 */
    enum sheen_jpeg_subsampling jpeg_subsampling; /* of SHEEN_FORMAT_JPEG */
    enum sheen_surface surface;
    uint32_t surface_level; /* 0 to 6; exact: 0 */
    enum sheen_class request_class;
    bool has_view;        /* a still request may then be replaced by a newer one of its view, as an
                             interactive one always may, which without a view is of view 0 */
    uint32_t view;        /* which of the program's pictures this is */
    uint32_t deadline_ms; /* from when the daemon has read it, at most 3600000; 0: none */
    bool undecoded;       /* SHEEN_FORMAT_RAW and _ZSTD: the frame's planes stay as they came, in
                             frame.data, laid out as protocol/README.md, chapter 5, says; for who
                             passes them on or stores them */
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
/* Writes the defaults into the first `size` bytes. */
void sheen_request_init(struct sheen_request *request, size_t size);

/* What the daemon spent, in microseconds; 0: not done for this frame. Visibility, evaluate and
 * shade are the device's own time where its timer queries count all of it (hardware); the rest is
 * by the clock, and total_us from the request's last byte to the answer's first. */
struct sheen_times {
    uint64_t tables_us, visibility_us, evaluate_us, shade_us, readback_us, encode_us, total_us;
};

/* A frame. It begins as SHEEN_FRAME_DEFAULTS; it may then be given to any number of calls, which
 * reuse its memory, and at last to sheen_frame_finish(). After a failure its other members are
 * undefined, but it may still be reused and must still be finished. */
struct sheen_frame {
    size_t size;
    struct sheen_frame_memory *memory; /* the library's */
    uint32_t number;        /* of its request: sheen_last_number(); set whatever the answer is */
    uint32_t superseded_by; /* SHEEN_SUPERSEDED: the request that took its place */
    uint32_t width_px, height_px;
    uint32_t planes;
    enum sheen_format format;
    uint8_t *data;     /* a file's bytes, or planes that were to stay undecoded; else NULL */
    size_t data_bytes; /* that travelled */
    void *plane[SHEEN_N_PLANES]; /* decoded planes by bit number; rows top first, tightly packed;
                                    NULL for planes that were not asked for, or are in `data` */
    struct sheen_camera camera;  /* as used */
    struct sheen_lines lines;
    uint32_t n_lights;
    struct sheen_light lights[SHEEN_MAX_LIGHTS];
    bool blank;         /* no pixel shows any of the model */
    double light_share; /* of the surface that is seen: where a light is met, 0 to 1; NAN where no
                           lines are drawn, nothing is seen or the daemon is too old to say */
    double up[3]; /* of the model, by which camera and lights were chosen as far as left out */
    enum sheen_up_source up_source;
    double show_range; /* of false colour, as used; 0: none */
    struct sheen_extreme show_least, show_greatest;
    bool has_colours; /* the daemon says what it used: */
    float miss[4], empty[4], base[4];
    struct sheen_times times;
    char device[128], driver[128], server[32];
    bool software;
    uint32_t threads; /* of the native device; 0: a GPU, or a driver or daemon that does not say */
};
#define SHEEN_FRAME_DEFAULTS ((struct sheen_frame){.size = sizeof(struct sheen_frame)})

/* Renders one frame: sheen_send() and sheen_receive(). */
enum sheen_status sheen_render(struct sheen_session *session, const struct sheen_request *request,
                               const struct sheen_progress *progress, struct sheen_frame *frame,
                               struct sheen_error *error);

/* Sends a request without waiting for its answer. Up to sheen_server.max_in_flight requests may be
 * in flight (SHEEN_BAD_ARGUMENT beyond). */
enum sheen_status sheen_send(struct sheen_session *session, const struct sheen_request *request,
                             struct sheen_error *error);

/* Waits for the next answer: frames of a class come in the order sent, failures as soon as the
 * daemon knows; frame->number tells whose answer it is. A request that the daemon refuses, replaces
 * or gives up fails here. One whose frame was lost with the daemon's GPU is sent again, up to
 * SHEEN_MAX_RETRIES times, and its frame comes after what was sent meanwhile; but when a newer
 * request of its view is in flight, that takes its place (SHEEN_SUPERSEDED). SHEEN_BAD_ARGUMENT
 * when nothing is in flight. */
#define SHEEN_MAX_RETRIES 5
enum sheen_status sheen_receive(struct sheen_session *session,
                                const struct sheen_progress *progress, struct sheen_frame *frame,
                                struct sheen_error *error);

/* sheen_receive() without waiting: SHEEN_AGAIN when no answer is whole yet. *frame then stays, and
 * what has come of the answer is kept in the session. Any frame may be given the next time. A
 * program calls it until it says SHEEN_AGAIN, and only then waits on sheen_descriptor(): bytes that
 * were read ahead wake no poll(). timeout_ms is the program's to hold. It may wait after all, for a
 * moment, to send a request again, and to learn why a private daemon has ended. */
enum sheen_status sheen_try_receive(struct sheen_session *session,
                                    const struct sheen_progress *progress,
                                    struct sheen_frame *frame, struct sheen_error *error);

/* The number of the request sent last; never 0 after a sheen_send(). */
uint32_t sheen_last_number(const struct sheen_session *session);

/* Takes back a request that has been sent and not yet received. Its answer still comes, as
 * SHEEN_CANCELLED or as whatever was on its way. SHEEN_BAD_ARGUMENT when no such request is in
 * flight, or the daemon is too old to know cancelling. */
enum sheen_status sheen_cancel(struct sheen_session *session, uint32_t number,
                               struct sheen_error *error);

/* Frees what the frame holds, and zeroes it but for its size. NULL and a zeroed frame are safe. */
void sheen_frame_finish(struct sheen_frame *frame);

/* ---- statistics ---- */

/* Of a class's frames in the last minute: from the request's last byte to the answer's first, to
 * 3 %; zeros when there were none. */
struct sheen_latency {
    uint64_t frames, p50_us, p95_us, p99_us;
};

struct sheen_stats {
    size_t size;
    uint64_t uptime_us;
    uint32_t sessions, queued; /* now */
    uint64_t frames, errors;   /* since the start */
    uint32_t models, images;   /* held now */
    uint64_t model_bytes;      /* tables on the GPU */
    uint64_t uploads_bytes, sent_bytes;
    uint64_t superseded, cancelled, late;        /* requests answered so, since the start */
    uint64_t disconnected;                       /* clients: over a limit, broke the protocol */
    uint64_t interactive_us, still_us, batch_us; /* of the renderer's time, by class */
    uint64_t memory_bytes;                       /* of the budget, in use now */
    struct sheen_times mean;                     /* over the last 64 frames */
    /* The last minute, or what of it there has been; window_us is 0 when the daemon is too old to
     * say. Percentiles are of each stage by itself, to 3 %; 0: no frame needed it. */
    uint64_t window_us, window_requests, window_frames;
    uint64_t window_sent_bytes; /* since the first of its answers */
    struct sheen_latency interactive, still, batch;
    struct sheen_times p50, p95, p99;
    char device[128], driver[128], server[32];
    bool software;
    uint32_t threads; /* of the native device; 0: a GPU, or a driver or daemon that does not say */
};
#define SHEEN_STATS_DEFAULTS ((struct sheen_stats){.size = sizeof(struct sheen_stats)})

/* What the daemon is doing. Not while requests are in flight (SHEEN_BAD_ARGUMENT). */
enum sheen_status sheen_query_stats(struct sheen_session *session, struct sheen_stats *stats,
                                    struct sheen_error *error);

/* ---- the defaults as functions, for C++ ---- */

static inline struct sheen_connect_options sheen_connect_defaults(void)
{
    struct sheen_connect_options options;
    sheen_connect_options_init(&options, sizeof(options));
    return options;
}

static inline struct sheen_request sheen_request_defaults(void)
{
    struct sheen_request request;
    sheen_request_init(&request, sizeof(request));
    return request;
}

static inline struct sheen_pattern sheen_pattern_defaults(void)
{
    struct sheen_pattern pattern;
    sheen_pattern_init(&pattern);
    return pattern;
}

static inline struct sheen_frame sheen_frame_defaults(void)
{
    struct sheen_frame frame;
    sheen_struct_init(&frame, sizeof(frame));
    return frame;
}

static inline struct sheen_server sheen_server_defaults(void)
{
    struct sheen_server server;
    sheen_struct_init(&server, sizeof(server));
    return server;
}

static inline struct sheen_model_info sheen_model_info_defaults(void)
{
    struct sheen_model_info info;
    sheen_struct_init(&info, sizeof(info));
    return info;
}

static inline struct sheen_stats sheen_stats_defaults(void)
{
    struct sheen_stats stats;
    sheen_struct_init(&stats, sizeof(stats));
    return stats;
}

#if defined(__GNUC__)
#pragma GCC visibility pop
#endif
#ifdef __cplusplus
}
#endif

#endif
