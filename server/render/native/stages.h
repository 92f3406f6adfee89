/* Runs the programs of shaders/ over a target's pixels, on all threads of a device. Internal to the folder; the
 * thread that has the device. */
#ifndef SHEEN_RENDER_NATIVE_STAGES_H
#define SHEEN_RENDER_NATIVE_STAGES_H

#include "server/render/frame_watch.h"
#include "server/render/light_block.h"
#include "server/render/native/device_internal.h"

/* A tile while it is drawn. */
struct native_drawing {
    struct native_device *device;
    struct native_target *target;
    const struct native_shown *shown;
    const struct frame_request *request;
    struct view_block view;
    const struct view *exact_view; /* the same in double precision */
    struct tile place;             /* the part of the picture in the target */
    struct tile inside;            /* in that, the tile without its margin */
};

struct native_bindings native_bindings_of(const struct native_drawing *drawing);
/* Runs a program that lists no pixels. */
void native_run_program(const struct native_drawing *drawing, native_program *program,
                        const struct native_bindings *bindings, uint32_t n_workgroups);
/* After stage 2: computes what later stages need in addition to its planes, and lists the groups of pixels near
 * visible surface. */
void native_find_groups(const struct native_drawing *drawing);
/* True if stage 1 found any surface. */
bool native_any_seen(const struct native_target *target);
/* Lists the pixels that one sample cannot show, finds where silhouettes cross them, and meets their rays with the
 * surface (shaders/edges.glsl). False with ERROR_SERVER when memory is short. */
bool native_edges(const struct native_drawing *drawing, struct error *error);
/* Stage 3, light by light. Adds to frame->seen_px and met_px if they are counted. False with ERROR_SERVER when nobody
 * waits or memory is short. */
bool native_shade(const struct native_drawing *drawing, const struct frame_watch *watch,
                  struct frame *frame, struct error *error);

#endif
