/* libsheen: exact reflection lines on subdivision surfaces, rendered by a daemon (sheend), for
 * programs in C11 and C++17. This is the library's only public header.
 *
 *     struct sheen_error error;
 *     struct sheen_connect_options options = SHEEN_CONNECT_DEFAULTS; // a private daemon
 *     struct sheen_request request = SHEEN_REQUEST_DEFAULTS;         // 1280x720, a PNG file
 *     struct sheen_frame frame = SHEEN_FRAME_DEFAULTS;
 *     struct sheen_session *session = NULL;
 *     uint8_t *bytes = NULL;
 *     size_t n_bytes;
 *
 *     if (sheen_read_file(SHEEN_FILE_MODEL, "hood.obj", &bytes, &n_bytes, &error))
 *         return show(error.text);
 *     sheen_file_id(bytes, n_bytes, request.model_id);
 *     if (sheen_connect(&session, &options, &error) ||
 *         sheen_upload(session, SHEEN_FILE_MODEL, request.model_id, bytes, n_bytes, "hood.obj",
 *                      NULL, &error) ||
 *         sheen_render(session, &request, NULL, &frame, &error))
 *         show(error.text);
 *     else
 *         fwrite(frame.data, 1, frame.data_bytes, out);
 *     sheen_frame_finish(&frame);
 *     sheen_close(session);
 *     free(bytes);
 *
 * In C++ the defaults are functions: `sheen_request request = sheen_request_defaults();`.
 *
 * Blocking: a call blocks until it is done, until it fails, or until no byte was transferred for
 * `timeout_ms`. A program with its own event loop waits on sheen_descriptor() and receives frames
 * by sheen_try_receive().
 *
 * Failure: functions return SHEEN_OK (0) or another status; then they fill in *error, which may be
 * NULL. After a status for which sheen_status_is_fatal() is true, the only valid call with the
 * session is sheen_close(); after any other status the session can still be used. Arguments are
 * checked: a NULL that is not allowed, NaN and values out of range return SHEEN_BAD_ARGUMENT, and
 * nothing is sent.
 *
 * Ownership: strings and buffers that the program passes are used during the call only. The library
 * owns everything that it returns, except where a comment says otherwise.
 *
 * Compatibility: a later version of the library with the same soname may add members at the end of
 * the structs that begin with `size`, but not of other structs. New members never use padding of the
 * earlier struct, so that `size` tells which members a program has. `size` is the struct's sizeof in
 * the program, which the defaults set, and at least 16. The library never touches bytes beyond it.
 *   - Program compiled with an older sheen.h: members that it does not have get their defaults when the
 *     struct is an argument, and are not written when the struct is a result.
 *   - Program compiled with a newer sheen.h: members that the library does not have must be zero in an
 *     argument (else SHEEN_BAD_ARGUMENT), and are zero in a result.
 * Enumerators keep their numbers.
 *
 * Thread: a session is used by one thread at a time; different sessions are independent. The
 * library raises no SIGPIPE, installs no signal handler and keeps no global state.
 *
 * Units: pixels `_px`, microseconds `_us`, milliseconds `_ms`, degrees `_deg`. Coordinates are in
 * the model file's own units, right-handed. Pixel (0,0) is at the top left. */
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
#define SHEEN_N_PLANES 8       /* number of planes in enum sheen_plane */
#define SHEEN_MAX_IN_FLIGHT 64 /* largest number of requests in flight with any daemon */

enum sheen_status {
    SHEEN_OK,
    SHEEN_BAD_ARGUMENT,  /* refused by the library, nothing was sent     exit code 2 */
    SHEEN_BAD_REQUEST,   /* refused by the daemon: out of its limits     exit code 2 */
    SHEEN_BAD_MODEL,     /* the cage is bad or not supported             exit code 3 */
    SHEEN_BAD_IMAGE,     /* an image is bad, or a file cannot be written exit code 3 */
    SHEEN_TOO_BIG,       /* the file exceeds the daemon's limit          exit code 3 */
    SHEEN_UNKNOWN_MODEL, /* the daemon does not have the file: upload it exit code 4 */
    SHEEN_OVERLOADED,    /* the daemon is full: try later                exit code 4 */
    SHEEN_SUPERSEDED,    /* a newer request of the same view replaced it exit code 4 */
    SHEEN_CANCELLED,     /* cancelled by sheen_cancel()                  exit code 4 */
    SHEEN_LATE,          /* not drawn within its deadline                exit code 4 */
    SHEEN_GPU_LOST,      /* the daemon's GPU was lost repeatedly         exit code 4 */
    SHEEN_SHUTTING_DOWN, /* fatal: the daemon is shutting down           exit code 4 */
    SHEEN_NO_SERVER,     /* fatal: cannot connect or start a daemon      exit code 4 */
    SHEEN_LOST_SERVER,   /* fatal: the connection broke                  exit code 4 */
    SHEEN_TIMEOUT,       /* fatal: no byte transferred for timeout_ms    exit code 4 */
    SHEEN_BAD_PEER,      /* fatal: the peer broke the protocol           exit code 4 */
    SHEEN_BAD_VERSION,   /* fatal: the peer speaks another major version exit code 4 */
    SHEEN_NO_MEMORY,     /* fatal: the program's memory is short         exit code 4 */
    SHEEN_DEVICE_FAILED, /* EGL or the GPU failed, or there is none      exit code 5 */
    SHEEN_AGAIN,         /* sheen_try_receive(): no complete answer yet  exit code 4 */
};

struct sheen_error {
    enum sheen_status status;
    char text[640]; /* one line of UTF-8 without newline: what failed, where, and what to do */
};

/* The version of the library and of the protocol: "0.1.0, protocol 1.3". A static string. */
const char *sheen_version(void);

/* The exit code with which the `sheen` command ends after this status: 0, 2, 3, 4 or 5. */
int sheen_status_exit_code(enum sheen_status status);
/* True if the session can only be closed after this status. */
bool sheen_status_is_fatal(enum sheen_status status);

/* Zeroes a struct of `size` bytes that begins with `size`, and sets that member: these are the
 * defaults of the structs that the library fills in. For languages that cannot use the macros
 * below. Does nothing if size is below 16. */
void sheen_struct_init(void *sized_struct, size_t size);

/* ---- sessions ---- */

struct sheen_session;

struct sheen_connect_options {
    size_t size;
    /* unix:PATH, tcp:HOST:PORT or tls:HOST:PORT; NULL: start a private daemon. */
    const char *address;
    /* Private daemon: the device that draws. "auto" or NULL: a GPU, else the processors; "software"
     * or "native": the processors; or the number of an EGL device. */
    const char *device;
    /* Private daemon: the memory for files, tables and frames together, in bytes, at least 36 MiB;
     * 0: half of the memory that this machine has or that the program's control group allows. */
    uint64_t memory_budget_bytes;
    uint32_t timeout_ms;         /* longest time without a transferred byte; 0: no limit */
    uint32_t connect_timeout_ms; /* the same during sheen_connect(); 0: timeout_ms */
    /* A load balancer may choose a node by this id: that of the model that will be requested, or,
     * for a model file at the server, sheen_file_id() of the text "server:NAME". Zeros: any
     * node. */
    uint8_t model_id[SHEEN_ID_BYTES];
    /* For tls: addresses: PEM files. The daemon's certificate is verified against `ca`; NULL:
     * against the authorities that the system trusts. The daemon may demand a certificate (cert and
     * key) or a token from the client. */
    const char *ca, *cert, *key;
    const char *token; /* only sent over TLS; NULL: none */
    /* Other clients may use the files that this session uploads, if they know their SHA-256. */
    bool share;
    /* Private daemon without a GPU: the x86-64 level of the vector code, "v2", "v3" or "v4"; "auto"
     * or NULL: the best that the processor has. */
    const char *native_isa;
    /* Private daemon without a GPU: the number of threads that draw, 1 to 64; 0: one for each
     * processor that it may use. */
    uint32_t native_threads;
};
#define SHEEN_CONNECT_DEFAULTS                                                                     \
    ((struct sheen_connect_options){.size = sizeof(struct sheen_connect_options),                  \
                                    .timeout_ms = 300000})
/* Writes the defaults into a struct of `size` bytes. */
void sheen_connect_options_init(struct sheen_connect_options *options, size_t size);

/* Connects to a daemon, or starts a private one, and exchanges greetings. On success *session is to
 * be closed with sheen_close(); on failure it is NULL. The status is then
 *
 *   SHEEN_BAD_ARGUMENT   a bad option, or a certificate or key that cannot be read
 *   SHEEN_NO_SERVER      cannot connect, or cannot start a private daemon
 *   SHEEN_LOST_SERVER    the daemon closed the connection, or the private daemon ended at once
 *   SHEEN_DEVICE_FAILED  the private daemon found no usable device
 *   SHEEN_BAD_PEER, SHEEN_BAD_VERSION, SHEEN_TIMEOUT, SHEEN_OVERLOADED
 *
 * A private daemon is a child process on a socket pair. Its program is $SHEEN_DAEMON, else `sheend`
 * in the folder of the running program, else `sheend` on the PATH. It ends when the session is
 * closed. It inherits no file except its socket. Its standard error is kept, and explains its end
 * if it dies. */
enum sheen_status sheen_connect(struct sheen_session **session,
                                const struct sheen_connect_options *options,
                                struct sheen_error *error);

/* Closes the session; ends its private daemon and waits for it. NULL is safe. */
void sheen_close(struct sheen_session *session);

/* What the daemon says about itself. The strings are valid as long as the session. */
struct sheen_server {
    size_t size;
    const char *version;
    const char *device, *driver;
    bool software;
    uint32_t max_width_px, max_height_px;
    uint64_t max_upload_bytes;
    uint32_t max_in_flight; /* limit of requests in flight, 1 to SHEEN_MAX_IN_FLIGHT */
};
#define SHEEN_SERVER_DEFAULTS ((struct sheen_server){.size = sizeof(struct sheen_server)})

/* Fills in *server; sends nothing. Fails only with SHEEN_BAD_ARGUMENT. */
enum sheen_status sheen_get_server(const struct sheen_session *session, struct sheen_server *server,
                                   struct sheen_error *error);

/* The session's socket, for poll() or an event loop. Only the library may read, write or close it.
 * *events is set to the events to wait for before the next sheen_try_receive(): POLLIN, or POLLOUT
 * while TLS must write first. Returns -1 and sets *events to 0 if the session is NULL or has
 * failed. */
int sheen_descriptor(const struct sheen_session *session, short *events);

/* report() is called during long calls: for uploads with the stage "upload" and bytes, else with a
 * stage that the daemon reports, such as "tables" with faces. `done` may reach `total`. It must not
 * call functions with the session. */
struct sheen_progress {
    void (*report)(void *context, const char *stage, uint64_t done, uint64_t total);
    void *context;
};

/* ---- files ---- */

enum sheen_file_kind { SHEEN_FILE_MODEL, SHEEN_FILE_IMAGE };

/* Computes the id of a file: the SHA-256 of its bytes. False only if libcrypto fails. */
bool sheen_file_id(const void *bytes, size_t n_bytes, uint8_t id[SHEEN_ID_BYTES]);

/* Reads a file of 1 byte to 1 GiB for sheen_upload(). A glTF model as JSON (.gltf) may name files that
 * hold its buffers: those are read as well, and *bytes is a GLB file that contains model and
 * buffers. Only files in the model's folder or below are read, also where a name is a symbolic link,
 * and no URL is fetched. Images that a model names are not read, because a cage has none.
 *
 * On success *bytes has *n_bytes bytes from malloc(), which the program frees by free(); on failure
 * *bytes is NULL. SHEEN_BAD_MODEL or SHEEN_BAD_IMAGE, by `kind`, if a file cannot or must not be
 * read; SHEEN_TOO_BIG if it is larger, together with its buffers; SHEEN_NO_MEMORY. Needs no session,
 * any thread. */
enum sheen_status sheen_read_file(enum sheen_file_kind kind, const char *path, uint8_t **bytes,
                                  size_t *n_bytes, struct sheen_error *error);

/* Uploads a file, unless the daemon has it; a broken upload continues where it stopped. `id` is
 * sheen_file_id() of the bytes; the daemon verifies it. `name` is the file's name; folders in it
 * are dropped, and its ending tells a model's format. In an OBJ file the line "t weld 0/0/0" joins
 * vertices at equal positions. progress may be NULL. SHEEN_BAD_ARGUMENT while requests are in
 * flight; SHEEN_TOO_BIG, SHEEN_BAD_MODEL or SHEEN_BAD_IMAGE if the daemon refuses the file. */
enum sheen_status sheen_upload(struct sheen_session *session, enum sheen_file_kind kind,
                               const uint8_t id[SHEEN_ID_BYTES], const void *bytes, size_t n_bytes,
                               const char *name, const struct sheen_progress *progress,
                               struct sheen_error *error);

/* Gets the id of a model file in the daemon's own folder (--models); `name` is its path there.
 * Builds the model's tables if needed. SHEEN_BAD_MODEL if there is no such file or it is bad,
 * SHEEN_BAD_REQUEST if the daemon has no such folder. */
enum sheen_status sheen_find_model(struct sheen_session *session, const char *name,
                                   const struct sheen_progress *progress,
                                   uint8_t id[SHEEN_ID_BYTES], struct sheen_error *error);

/* Properties of a model that are probably mistakes. `warnings` describes each in words. */
enum sheen_finding_kind {
    SHEEN_FINDING_REPEATED_CORNER, /* faces with a corner equal to the next one, which is dropped */
    SHEEN_FINDING_FEW_CORNERS,     /* faces left out: fewer than three different corners */
    /* Faces left out: a vertex occurs at two corners that are not adjacent. */
    SHEEN_FINDING_KEYHOLE,
    SHEEN_FINDING_CREASE_WITHOUT_EDGE,   /* creases left out: no such edge */
    SHEEN_FINDING_CORNER_WITHOUT_VERTEX, /* sharp vertices left out: no such vertex */
    SHEEN_FINDING_HOLE_WITHOUT_FACE,     /* holes left out: no such face */
    SHEEN_FINDING_UNWELDED,  /* positions that repeat, in a model whose faces share no vertices */
    SHEEN_FINDING_TRIANGLES, /* faces that are plain triangles */
    SHEEN_FINDING_WOUND_AGAINST, /* edges that two faces traverse in the same direction */
    SHEEN_FINDING_FACE_TWICE,    /* faces that occur twice */
    SHEEN_FINDING_INSIDE_OUT,    /* closed bodies whose normals point inwards */
    SHEEN_FINDING_OTHER,         /* a kind that this library does not know */
};

struct sheen_finding {
    enum sheen_finding_kind kind;
    uint32_t count; /* how many, from 1 */
    uint32_t line;  /* line in the file of the first one, from 1; 0: unknown */
    bool has_face;  /* the file has no lines, so `face` is set */
    uint32_t face;  /* the first face, from 0 */
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
    /* Entries of `extraordinary`; if there are more valences, the last entry sums the rest. */
    uint32_t n_valences;
    struct sheen_valence
        extraordinary[SHEEN_MAX_VALENCES]; /* interior vertices that do not have 4 edges */
    uint32_t boundary_extraordinary;       /* boundary vertices that do not have 2 faces */
    uint32_t sharp_edges, semisharp_edges; /* creases: infinitely sharp; of finite sharpness */
    uint32_t sharp_vertices;               /* vertices with a sharpness of their own */
    uint32_t holes;                        /* faces that are holes */
    /* Edges of 3 or more faces, or that 2 faces traverse in the same direction. */
    uint32_t nonmanifold_edges;
    uint32_t nonmanifold_vertices; /* vertices whose faces are not a single fan */
    uint32_t regular_patches, corner_patches, strip_patches, split_nodes, hole_nodes;
    /* Memory of the tables on the GPU; without a GPU in main memory. */
    uint64_t table_bytes;
    uint64_t regular_bytes, corner_bytes; /* bytes of one such patch */
    uint64_t tables_us;                   /* time to read, build and upload */
    double box_min[3], box_max[3];
    char warnings[4096]; /* lines of text; "": none */
    uint32_t n_findings; /* entries of `findings`, at most one of each kind */
    struct sheen_finding findings[SHEEN_MAX_FINDINGS];
};
#define SHEEN_MODEL_INFO_DEFAULTS                                                                  \
    ((struct sheen_model_info){.size = sizeof(struct sheen_model_info)})

/* Describes an uploaded model and its cost. Builds the model's tables if needed. */
enum sheen_status sheen_query_model(struct sheen_session *session, const uint8_t id[SHEEN_ID_BYTES],
                                    const struct sheen_progress *progress,
                                    struct sheen_model_info *info, struct sheen_error *error);

/* ---- frames ---- */

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

enum sheen_format {
    SHEEN_FORMAT_RAW,  /* decoded planes, sent uncompressed */
    SHEEN_FORMAT_ZSTD, /* decoded planes, sent with lossless compression */
    SHEEN_FORMAT_PNG,  /* a file with the colour plane */
    SHEEN_FORMAT_EXR,  /* a file with any planes */
    SHEEN_FORMAT_JPEG, /* a file with the colour plane, without alpha */
    SHEEN_FORMAT_TIFF, /* a file with the colour plane */
};

enum sheen_projection {
    SHEEN_PROJECTION_AUTO, /* the daemon frames the model; other members are ignored */
    SHEEN_PROJECTION_PERSPECTIVE,
    SHEEN_PROJECTION_ORTHOGRAPHIC,
};

/* Where a model's up direction comes from. */
enum sheen_up_source {
    SHEEN_UP_GIVEN,   /* the request */
    SHEEN_UP_FILE,    /* the model's file: y in glTF */
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
    double eye[3], target[3]; /* must differ */
    /* Not parallel to the line of sight; need not be perpendicular to it. */
    double up[3];
    double fov_deg;      /* perspective: vertical field of view, 1e-6 to 179 */
    double ortho_height; /* orthographic: height of the picture in units, > 0 */
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
    /* Length of a period in the light's units, > 0; 0: `count` decides. */
    double period;
    double duty;                 /* bright share of a period, 0 to 1 */
    double rotation_deg, offset; /* rotation; offset in periods */
    /* Width of each soft edge, as a share of a period (SHEEN_PATTERN_LINES: of the line's width), 0
     * to 1. */
    double soft;
    double opacity; /* opacity over the shaded surface, 0 to 1 */
    /* SHEEN_PATTERN_LINES: number of lines, 1 to SHEEN_MAX_LINES; else 0. */
    uint32_t n_at;
    /* SHEEN_PATTERN_LINES: place and width of the lines, in widths of the light. */
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
    /* Isophotes: the direction that normals are compared with; without it, the direction to the
     * eye. Zebra and environment: the axis; without it, up. */
    bool has_direction;
    double direction[3];          /* not zero */
    enum sheen_line_eye eye_kind; /* the eye for which the lines are computed */
    double eye[3];                /* a point, or a direction of view, which is not zero */
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

/* The least or greatest value of false colour at the centre of a pixel, and its place. */
struct sheen_extreme {
    bool has_value; /* false: no pixel has a value, or the daemon is too old to tell */
    double value;
    bool has_place;      /* false: the values are equal everywhere */
    uint32_t x_px, y_px; /* the first such pixel: topmost, then leftmost */
    double position[3];
    bool has_ptex; /* the frame has the Ptex plane, so face, u and v are set */
    uint32_t face;
    double u, v;
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

/* A frame that shows a part of a picture: the place of the frame's top left corner in the picture, and
 * the picture's size, for which the camera is. The part must be inside. All 0: the frame is the whole
 * picture. */
struct sheen_window {
    double x_px, y_px;            /* from 0; not only whole numbers */
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
     * plane. Patterns are still averaged over the pixel. SHEEN_BAD_ARGUMENT with an older daemon. */
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

/* The time that the daemon spent, in microseconds; 0: not needed for this frame. visibility_us,
 * evaluate_us and shade_us are measured by the GPU where it has timer queries for all of it, else
 * by the clock. total_us lasts from the request's last byte to the answer's first. */
struct sheen_times {
    uint64_t tables_us, visibility_us, evaluate_us, shade_us, readback_us, encode_us, total_us;
};

/* A frame. Initialise it with SHEEN_FRAME_DEFAULTS, pass it to any number of calls, which reuse its
 * memory, and free it by sheen_frame_finish(). After a failure its members are undefined, except
 * for `number` and `superseded_by`; it may still be reused, and must still be finished. */
struct sheen_frame {
    size_t size;
    struct sheen_frame_memory *memory; /* private to the library */
    /* The number of the frame's request (sheen_last_number()); set for every answer. */
    uint32_t number;
    uint32_t superseded_by; /* SHEEN_SUPERSEDED: the number of the request that replaced it */
    uint32_t width_px, height_px;
    uint32_t planes;
    enum sheen_format format;
    uint8_t *data;     /* the bytes of a file, or undecoded planes; else NULL */
    size_t data_bytes; /* bytes received */
    /* Decoded planes by bit number: contiguous rows, top row first; NULL for planes that were not
     * requested or are in `data`. */
    void *plane[SHEEN_N_PLANES];
    struct sheen_camera camera; /* the camera that was used */
    struct sheen_lines lines;
    uint32_t n_lights;
    struct sheen_light lights[SHEEN_MAX_LIGHTS];
    bool blank; /* no pixel shows the model */
    /* Share of the visible surface whose rays meet a light, 0 to 1; NAN if no lines are drawn, no
     * surface is visible, or the daemon is too old to tell. */
    double light_share;
    /* The model's up direction, by which missing parts of camera and lights were chosen. */
    double up[3];
    enum sheen_up_source up_source;
    double show_range; /* the range of false colour that was used; 0: none */
    struct sheen_extreme show_least, show_greatest;
    bool has_colours; /* the daemon told the colours that it used: */
    float miss[4], empty[4], base[4];
    struct sheen_times times;
    char device[128], driver[128], server[32];
    bool software;
    uint32_t threads; /* threads that draw without a GPU; 0: a GPU, or unknown */
};
#define SHEEN_FRAME_DEFAULTS ((struct sheen_frame){.size = sizeof(struct sheen_frame)})

/* Renders one frame: sheen_send(), then sheen_receive(). */
enum sheen_status sheen_render(struct sheen_session *session, const struct sheen_request *request,
                               const struct sheen_progress *progress, struct sheen_frame *frame,
                               struct sheen_error *error);

/* Sends a request without waiting for its answer. SHEEN_BAD_ARGUMENT if sheen_server.max_in_flight
 * requests are in flight (sent, but their answer not received). */
enum sheen_status sheen_send(struct sheen_session *session, const struct sheen_request *request,
                             struct sheen_error *error);

/* Waits for the next answer. Frames of one class come in the order of their requests, failures as
 * soon as the daemon knows them; frame->number tells which request is answered. A request that the
 * daemon refuses, replaces or gives up is a failure of this call. SHEEN_BAD_ARGUMENT if no request
 * is in flight.
 *
 * If a frame is lost because the daemon lost its GPU, the library sends the request again, up to
 * SHEEN_MAX_RETRIES times; its frame then comes after those of later requests. If a newer request
 * of the same view is in flight, the older one is not sent again: SHEEN_SUPERSEDED. */
#define SHEEN_MAX_RETRIES 5
enum sheen_status sheen_receive(struct sheen_session *session,
                                const struct sheen_progress *progress, struct sheen_frame *frame,
                                struct sheen_error *error);

/* As sheen_receive(), but returns SHEEN_AGAIN instead of waiting for a complete answer. Then *frame
 * is unchanged, the session keeps the part that has come, and the next call may use another frame.
 * Call it until it returns SHEEN_AGAIN before waiting on sheen_descriptor(): bytes that the library
 * has already read do not wake poll(). The program must watch timeout_ms itself. The call may block
 * for a moment to send a request again, or to find out why a private daemon has ended. */
enum sheen_status sheen_try_receive(struct sheen_session *session,
                                    const struct sheen_progress *progress,
                                    struct sheen_frame *frame, struct sheen_error *error);

/* The number of the latest request sent; never 0 after a sheen_send(). */
uint32_t sheen_last_number(const struct sheen_session *session);

/* Cancels a request in flight. Its answer still comes: SHEEN_CANCELLED, or the answer that was
 * already on its way. SHEEN_BAD_ARGUMENT if no such request is in flight, or if the daemon is too
 * old to cancel. */
enum sheen_status sheen_cancel(struct sheen_session *session, uint32_t number,
                               struct sheen_error *error);

/* Frees the frame's memory and zeroes it except for its size. NULL and a zeroed frame are safe. */
void sheen_frame_finish(struct sheen_frame *frame);

/* ---- numbers: where lines break ---- */

/* An edge is out of tolerance where it exceeds one of these; 0: the default. */
struct sheen_break_limits {
    size_t size;
    double gap;       /* units of the file; default: 1e-5 of the diagonal of the model's box */
    double angle_deg; /* between the normals of both sides, at most 180; default: 0.1 */
    double curvature_percent; /* jump of the curvature, at most 200; default: 10 */
};
#define SHEEN_BREAK_LIMITS_DEFAULTS                                                                \
    ((struct sheen_break_limits){.size = sizeof(struct sheen_break_limits)})

enum sheen_break_kind {
    SHEEN_BREAK_CREASE,    /* an infinitely sharp crease */
    SHEEN_BREAK_SEMISHARP, /* a crease of finite sharpness: smooth, and never out of tolerance */
    /* Two border edges that lie together: vertices that the file does not join, or two faces of an
     * edge with more than two. */
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
    double shift;                    /* units: the jump as a length on the surface; NAN: none */
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
    uint32_t n_borders;                       /* edges with a face on one side */
    double gap, angle_deg, curvature_percent; /* limits that were used */
    double creases_length, borders_length, out_length;
    double diagonal;            /* of the model's box */
    struct sheen_camera camera; /* that were used */
    struct sheen_lines lines;
    uint32_t n_lights;
    struct sheen_light lights[SHEEN_MAX_LIGHTS];
    uint64_t total_us;
    char server[32];
};
#define SHEEN_BREAKS_DEFAULTS ((struct sheen_breaks){.size = sizeof(struct sheen_breaks)})

/* Finds where the lines of request's model break, in double precision on the surface itself. Of the
 * request, model, camera, lines, lights and deadline_ms count; lights of images need no image.
 * `limits` may be NULL. protocol/README.md, chapter 10, and server/curves/README.md define all
 * measures. SHEEN_BAD_ARGUMENT while requests are in flight, or with a daemon that is too old. */
enum sheen_status sheen_find_breaks(struct sheen_session *session,
                                    const struct sheen_request *request,
                                    const struct sheen_break_limits *limits,
                                    const struct sheen_progress *progress,
                                    struct sheen_breaks *breaks, struct sheen_error *error);

/* Frees the memory of a result and zeroes it except for its size. NULL and a zeroed one are safe. */
void sheen_breaks_finish(struct sheen_breaks *breaks);

/* ---- statistics ---- */

/* Latency of one class's frames in the last minute, from the request's last byte to the answer's
 * first, exact to 3 %; zeros if there were none. */
struct sheen_latency {
    uint64_t frames, p50_us, p95_us, p99_us;
};

struct sheen_stats {
    size_t size;
    uint64_t uptime_us;
    uint32_t sessions, queued; /* now */
    uint64_t frames, errors;   /* since the start */
    uint32_t models, images;   /* in the daemon's memory now */
    uint64_t model_bytes;      /* memory of tables on the GPU */
    uint64_t uploads_bytes, sent_bytes;
    uint64_t superseded, cancelled, late; /* requests with this answer since the start */
    /* Clients disconnected for exceeding a limit or breaking the protocol. */
    uint64_t disconnected;
    uint64_t interactive_us, still_us, batch_us; /* time of the renderer, by class */
    uint64_t memory_bytes;                       /* memory in use now, of the budget */
    struct sheen_times mean;                     /* mean of the last 64 frames */
    /* The last minute, or less soon after the start; window_us is 0 if the daemon is too old to
     * tell. Percentiles are computed for each stage separately, exact to 3 %; 0: no frame needed
     * the stage. */
    uint64_t window_us, window_requests, window_frames;
    uint64_t window_sent_bytes; /* since the first answer in the window */
    struct sheen_latency interactive, still, batch;
    struct sheen_times p50, p95, p99;
    char device[128], driver[128], server[32];
    bool software;
    uint32_t threads; /* threads that draw without a GPU; 0: a GPU, or unknown */
    /* The daemon's memory budget, and what holds it: models and images; what is being received;
     * frames, and computations, by class; what frames are drawn on; memory kept for the next frames;
     * what is set aside for the daemon itself. All 0 if the daemon is too old to tell. */
    uint64_t budget_bytes;
    uint64_t assets_bytes, input_bytes, interactive_bytes, patient_bytes;
    uint64_t device_bytes, spare_bytes, daemon_bytes;
};
#define SHEEN_STATS_DEFAULTS ((struct sheen_stats){.size = sizeof(struct sheen_stats)})

/* Asks for the daemon's statistics. SHEEN_BAD_ARGUMENT while requests are in flight. */
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

/* ---- numbers: how far two surfaces differ ---- */

/* What is compared at each sample; server/curves/README.md defines all measures. */
enum sheen_compare_measure {
    SHEEN_COMPARE_DISTANCE,    /* units; positive where the new surface is outside of the old one */
    SHEEN_COMPARE_NORMAL,      /* between the normals, up to winding, degrees */
    SHEEN_COMPARE_LINES,       /* shift of a light's lines, spacings */
    SHEEN_COMPARE_LINE_LENGTH, /* the same as a length on the surface, units */
    SHEEN_COMPARE_CURVATURE,   /* change of the larger principal curvature, as a share of it */
};
#define SHEEN_N_COMPARE_MEASURES 5

struct sheen_compare_options {
    size_t size;
    uint8_t new_id[SHEEN_ID_BYTES]; /* the model that is compared with the request's */
    /* Beyond it an area is out of tolerance. 0: the default: 1e-5 of the diagonal of the old model's
     * box; 0.05; 0.1; none; and curvature is not compared. */
    double limits[SHEEN_N_COMPARE_MEASURES];
    bool align;       /* move the new surface onto the old one first */
    uint32_t samples; /* of both surfaces together, about, 1000 to 100000000; 0: a million */
};
#define SHEEN_COMPARE_OPTIONS_DEFAULTS                                                             \
    ((struct sheen_compare_options){.size = sizeof(struct sheen_compare_options)})

struct sheen_compared_place {
    uint32_t face; /* Ptex face */
    double uv[2], position[3];
};

/* A measure over the samples of one surface. */
struct sheen_compared_measure {
    bool is_known;                     /* false: it has no value anywhere, or was not asked for */
    double worst;                      /* the value whose magnitude is largest */
    struct sheen_compared_place at[2]; /* where: on the old and on the new surface */
    double rms, p95, p99;              /* over the area */
    double area_out;                   /* beyond the limit, square units */
};

/* What the samples of one surface found on the other one. Areas are in square units. */
struct sheen_compared_side {
    uint64_t samples;
    double area;
    double area_uncovered; /* where the other surface is missing */
    double area_rewound;   /* whose counterpart is wound the other way around */
    double area_unlit;     /* where a light is met on one surface only */
    bool has_uncovered;    /* `uncovered` is a place where the other surface is missing */
    struct sheen_compared_place uncovered;
    struct sheen_compared_measure measures[SHEEN_N_COMPARE_MEASURES];
};

/* Initialise it with SHEEN_COMPARISON_DEFAULTS. It owns no memory. */
struct sheen_comparison {
    size_t size;
    struct sheen_compared_side sides[2]; /* the old surface's samples, and the new one's */
    bool is_rewound; /* the new surface as a whole is wound the other way around */
    bool is_aligned;
    double diagonal; /* of the old model's box */
    /* What equal surfaces of different files differ by: tables are in single precision. */
    double distance_floor, normal_floor_deg;
    double limits[SHEEN_N_COMPARE_MEASURES]; /* that were used; INFINITY: none */
    /* With is_aligned: the motion of the new surface, a rotation row by row and then a shift; the
     * rotation's angle; and the root mean square of the distances before and after. */
    double rotation[9], shift[3], rotation_deg, rms_before, rms_after;
    struct sheen_camera camera; /* that were used */
    struct sheen_lines lines;
    uint32_t n_lights;
    struct sheen_light lights[SHEEN_MAX_LIGHTS];
    uint64_t total_us;
    char server[32];
};
#define SHEEN_COMPARISON_DEFAULTS                                                                  \
    ((struct sheen_comparison){.size = sizeof(struct sheen_comparison)})

/* Compares request's model, the old one, with options->new_id, in double precision on the surfaces
 * themselves. Of the request, model, camera, lines, lights and deadline_ms count; lights of images
 * need no image. protocol/README.md, chapter 10. SHEEN_BAD_ARGUMENT while requests are in flight, or
 * with a daemon that is too old. */
enum sheen_status sheen_compare(struct sheen_session *session, const struct sheen_request *request,
                                const struct sheen_compare_options *options,
                                const struct sheen_progress *progress,
                                struct sheen_comparison *comparison, struct sheen_error *error);

static inline struct sheen_compare_options sheen_compare_options_defaults(void)
{
    struct sheen_compare_options options;
    sheen_struct_init(&options, sizeof(options));
    return options;
}

static inline struct sheen_comparison sheen_comparison_defaults(void)
{
    struct sheen_comparison comparison;
    sheen_struct_init(&comparison, sizeof(comparison));
    return comparison;
}

/* ---- numbers: lines as curves ---- */

struct sheen_curve_options {
    size_t size;
    /* Greatest distance of a curve from its chords, units of the file; 0: 1e-5 of the diagonal of the
     * model's box. */
    double tolerance;
    /* Places of lines on each light, as `at` of a pattern of lines; 0: those of the lights' patterns
     * (of stripes and lattices the middle of each bright stripe). */
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
    double tolerance, diagonal; /* as used; of the model's box */
    struct sheen_camera camera; /* that were used */
    struct sheen_lines lines;
    uint32_t n_lights;
    struct sheen_light lights[SHEEN_MAX_LIGHTS];
    uint64_t total_us;
    char server[32];
};
#define SHEEN_CURVES_DEFAULTS ((struct sheen_curves){.size = sizeof(struct sheen_curves)})

/* Traces the lines of request's lights on the surface as curves, none of which is lost. Of the
 * request, model, camera, lines, lights and deadline_ms count. `options` may be NULL.
 * protocol/README.md, chapter 10, and server/curves/README.md say how curves are found.
 * SHEEN_BAD_ARGUMENT while requests are in flight, or with a daemon that is too old. */
enum sheen_status sheen_trace_lines(struct sheen_session *session,
                                    const struct sheen_request *request,
                                    const struct sheen_curve_options *options,
                                    const struct sheen_progress *progress,
                                    struct sheen_curves *curves, struct sheen_error *error);

/* Frees the memory of a result and zeroes it except for its size. NULL and a zeroed one are safe. */
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
