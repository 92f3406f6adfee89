/* Frames: how requests are sent, and how their answers are received. sheen.h has the rules. */
#ifndef SHEEN_PUBLIC_FRAME_H
#define SHEEN_PUBLIC_FRAME_H

#include "base.h"
#include "request.h"
#include "scene.h"
#include "session.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

SHEEN_DECLARATIONS_BEGIN

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

/* Renders one frame: sheen_send(), then sheen_receive(). SHEEN_BAD_ARGUMENT while requests are in
 * flight. `progress` may be NULL. */
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

static inline struct sheen_frame sheen_frame_defaults(void)
{
    struct sheen_frame frame;
    sheen_struct_init(&frame, sizeof(frame));
    return frame;
}

SHEEN_DECLARATIONS_END

#endif
