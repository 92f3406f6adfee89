#include "server/render/gl/kept.h"

#include <assert.h>
#include <stddef.h>
#include <string.h>

#include "server/render/gl/device_internal.h"
#include "server/render/gl/frame_state.h"
#include "server/render/gl/model.h"

void planes_swap(struct gl_renderer *r, struct planes *others)
{
    const struct planes used = {r->target, r->kept};
    r->target = others->target;
    r->kept = others->kept;
    *others = used;
}

static void use(struct gl_renderer *r, enum planes_of which)
{
    if (r->in_use == which)
        return;
    planes_swap(r, &r->resting[r->in_use]);
    planes_swap(r, &r->resting[which]);
    r->in_use = which;
}

/* Finds the planes that hold the frame's view, equal bit by bit to planes drawn anew. PLANES_KINDS
 * if there are none. */
static enum planes_of find_kept(const struct gl_renderer *r, const struct gl_model *model,
                                const struct gl_frame *own, bool is_single)
{
    for (int i = PLANES_WHOLE; i <= PLANES_TILED; i++) {
        const struct kept_view *kept =
            r->in_use == (enum planes_of)i ? &r->kept : &r->resting[i].kept;
        bool same_cut = is_single == (i != PLANES_TILED);
        bool serves = same_cut || (kept->any_cut && (is_single || own->work->in_place));
        if (serves && kept_view_serves(kept, model->serial, own->work->request))
            return (enum planes_of)i;
    }
    return PLANES_KINDS;
}

void planes_choose(struct gl_renderer *r, const struct gl_model *model, struct gl_frame *own)
{
    const struct frame_request *request = own->work->request;
    bool is_exact = request->surface.kind == SURFACE_EXACT;
    bool is_single = own->tile.width == request->width_px && own->tile.height == request->height_px;
    bool in_place = is_exact && own->work->in_place, is_first = own->x == 0 && own->y == 0;
    if (is_first && (is_single || in_place)) {
        enum planes_of kept = find_kept(r, model, own, is_single);
        if (kept < PLANES_KINDS) {
            own->tile.width = request->width_px;
            own->tile.height = request->height_px;
            use(r, kept);
            return;
        }
    }
    use(r, is_single  ? kept_view_is_small(request) ? PLANES_SMALL : PLANES_WHOLE
           : in_place ? PLANES_TILED
                      : PLANES_APART);
}

static void drop(struct target *target, struct kept_view *kept)
{
    target_finish(target);
    *kept = (struct kept_view){0};
}

void planes_drop(struct gl_renderer *r)
{
    drop(&r->target, &r->kept);
    for (int i = 0; i < PLANES_KINDS; i++)
        drop(&r->resting[i].target, &r->resting[i].kept);
    r->collecting.frame = 0;
}

static uint64_t bytes_of(const struct target *target)
{
    return target->width == 0 ? 0
                              : target_bytes(target->width, target->height) +
                                    (uint64_t)target->max_rounded * ROUNDED_BYTES;
}

uint64_t planes_bytes(const struct gl_renderer *r)
{
    uint64_t bytes = bytes_of(&r->target);
    for (int i = 0; i < PLANES_KINDS; i++)
        bytes += bytes_of(&r->resting[i].target);
    return bytes;
}

/* --- tiles into one */

/* The lists that are collected, and how many of their entries a workgroup takes (list.glsl). */
enum { GROUPS, EDGES, ROUNDED };
static const struct {
    size_t member;
    GLuint per_group;
} LISTS[] = {
    [GROUPS] = {offsetof(struct target, groups), 8},
    [EDGES] = {offsetof(struct target, edges), 32},
    [ROUNDED] = {offsetof(struct target, rounded), 4},
};
static_assert(sizeof LISTS / sizeof *LISTS == COLLECTED_LISTS, "no list without an entry");

void collect_begin(struct gl_renderer *r, const struct gl_frame *own)
{
    r->kept.model_serial = 0;
    if (own->x == 0 && own->y == 0)
        r->collecting = (struct collecting){.frame = own->serial};
    else if (r->collecting.frame != own->serial)
        r->collecting.frame = 0;
}

static GLuint list_of(const struct target *target, int k)
{
    GLuint name;
    memcpy(&name, (const char *)target + LISTS[k].member, sizeof name);
    return name;
}

/* How many pixels or groups a list has. Waits for the device. */
static GLuint list_length(GLuint list)
{
    GLuint head[4];
    glGetNamedBufferSubData(list, 0, sizeof head, head);
    return head[3];
}

/* Writes a list's head in the form of list.glsl. */
static void write_head(GLuint list, GLuint n, GLuint per_group)
{
    GLuint groups = (n + per_group - 1) / per_group;
    const GLuint head[4] = {groups < GROUP_ROW ? groups : GROUP_ROW,
                            groups ? (groups - 1) / GROUP_ROW + 1 : 1, 1, n};
    glNamedBufferSubData(list, 0, sizeof head, head);
}

void collect_tile(struct gl_renderer *r, bool edges)
{
    const struct target *tile = &r->resting[PLANES_APART].target;
    struct collecting *all = &r->collecting;
    if (!all->frame)
        return;
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    for (int k = 0; k < (edges ? COLLECTED_LISTS : 1); k++) {
        GLuint from = list_of(tile, k), n = list_length(from);
        if (r->evaluate.too_many_gaps || (k == ROUNDED && all->n[k] + n > ROUNDED_IN_ANY_CUT)) {
            all->frame = 0;
            return;
        }
        if (n)
            glCopyNamedBufferSubData(from, list_of(&r->target, k), LIST_HEAD_BYTES,
                                     LIST_HEAD_BYTES + (GLintptr)all->n[k] * LIST_BYTES,
                                     (GLsizeiptr)n * LIST_BYTES);
        if (n && k == ROUNDED)
            glCopyNamedBufferSubData(tile->rounded_hits, r->target.rounded_hits, 0,
                                     (GLintptr)all->n[k] * ROUNDED_BYTES,
                                     (GLsizeiptr)n * ROUNDED_BYTES);
        all->n[k] += n;
    }
}

void collect_end(struct gl_renderer *r, const struct gl_model *model,
                 const struct frame_request *request)
{
    if (!r->collecting.frame)
        return;
    r->kept = kept_view_of(model->serial, request);
    for (int k = 0; k < (r->kept.edges ? COLLECTED_LISTS : 1); k++)
        write_head(list_of(&r->target, k), r->collecting.n[k], LISTS[k].per_group);
    r->collecting.frame = 0;
}

void planes_keep(struct gl_renderer *r, const struct gl_model *model,
                 const struct frame_request *request)
{
    if (kept_view_serves(&r->kept, model->serial, request))
        return;
    r->kept = kept_view_of(model->serial, request);
    if (r->evaluate.too_many_gaps ||
        (r->kept.edges && list_length(r->target.rounded) > ROUNDED_IN_ANY_CUT))
        r->kept.any_cut = false;
}
