#include "server/render/native/stages.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/render/native/denormals.h"
#include "server/render/native/patches.h"
#include "server/render/native/rays/rays.h"

enum { GROUPS_PER_WORKGROUP = 8 };
/* The most workgroups that a thread takes at a time, and the most pixels that one of them may list. */
enum { CHUNKS_PER_THREAD = 8, CHUNK = 32, WORKGROUP_PX = 64, CHUNK_PX = CHUNK * WORKGROUP_PX };
/* Pixels of a list that a workgroup of its program takes (shaders/edges.glsl, rounded.glsl). */
enum { EDGES_PER_WORKGROUP = 32, LISTED_PER_WORKGROUP = 64 };

/* --- programs */

/* A program run over workgroups, in chunks that threads take one after another. What it lists goes to a thread's own
 * list first. */
struct run {
    native_program *program;
    const struct native_bindings *bindings;
    uint32_t n_workgroups, next, chunk; /* chunk: number taken at a time */
    struct native_share *share;         /* where the program counts; NULL if it does not */
};

/* The lists that a program may add to. */
enum { ADDED_LISTS = 4 };

static struct native_list **added_list(struct native_bindings *bindings, int k)
{
    struct native_list **const lists[ADDED_LISTS] = {&bindings->edges, &bindings->parts,
                                                     &bindings->rounded, &bindings->rims};
    return lists[k];
}

static void append(struct native_list *to, const struct native_list *from)
{
    uint32_t at = __atomic_fetch_add(&to->n, from->n, __ATOMIC_RELAXED);
    if (from->n)
        memcpy(to->at.words + at, from->at.words, from->n * sizeof *from->at.words);
}

/* Runs one chunk, with lists that no other thread adds to. */
static void run_chunk(struct run *run, uint32_t first, uint32_t end)
{
    uint32_t words[ADDED_LISTS][CHUNK_PX]; /* programs fill it */
    struct native_list lists[ADDED_LISTS];
    struct native_bindings bindings = *run->bindings;
    struct native_share share = {0};
    for (int k = 0; k < ADDED_LISTS; k++) {
        /* cppcheck-suppress legacyUninitvar */
        lists[k] = (struct native_list){.at = {words[k], CHUNK_PX}};
        if (*added_list(&bindings, k))
            *added_list(&bindings, k) = &lists[k];
    }
    if (run->share) {
        share.met = run->share->met;
        bindings.Share = &share;
    }
    run->program(&bindings, first, end);
    struct native_bindings shared = *run->bindings;
    for (int k = 0; k < ADDED_LISTS; k++)
        if (*added_list(&shared, k))
            append(*added_list(&shared, k), &lists[k]);
    if (run->share) {
        __atomic_fetch_add(&run->share->seen_px, share.seen_px, __ATOMIC_RELAXED);
        __atomic_fetch_add(&run->share->met_px, share.met_px, __ATOMIC_RELAXED);
    }
}

static void work(void *owner, unsigned number)
{
    struct run *run = owner;
    (void)number;
    denormals before = denormals_flush();
    for (uint32_t first; (first = __atomic_fetch_add(&run->next, run->chunk, __ATOMIC_RELAXED)) <
                         run->n_workgroups;)
        run_chunk(run, first,
                  first + run->chunk < run->n_workgroups ? first + run->chunk : run->n_workgroups);
    denormals_restore(before);
}

static void run_program(const struct native_drawing *d, native_program *program,
                        const struct native_bindings *bindings, uint32_t n, uint32_t per_workgroup,
                        struct native_share *share)
{
    struct run run = {program, bindings, (n + per_workgroup - 1) / per_workgroup, .share = share};
    /* Small enough that no thread waits long for the last chunk of another. */
    run.chunk = run.n_workgroups / (CHUNKS_PER_THREAD * native_device_threads(d->device)) + 1;
    run.chunk = run.chunk < CHUNK ? run.chunk : CHUNK;
    if (run.n_workgroups)
        native_device_run(d->device, work, &run);
}

void native_run_program(const struct native_drawing *d, native_program *program,
                        const struct native_bindings *bindings, uint32_t n_workgroups)
{
    run_program(d, program, bindings, n_workgroups, 1, NULL);
}

struct native_bindings native_bindings_of(const struct native_drawing *d)
{
    const struct native_target *t = d->target;
    const struct limit_tables *tables = d->shown->base.tables;
    struct native_bindings b = {
        .View = &d->view,
        .texels = {d->shown->model, native_patch_texels},
        .heads = {(const uint32_t *)(const void *)tables->heads, (uint32_t)(4 * tables->n_nodes)},
        .nodes = {(const uint32_t *)(const void *)tables->nodes, (uint32_t)(3 * tables->n_nodes)},
        .adjacency = {(const uint32_t *)(const void *)tables->adjacency, (uint32_t)tables->n_faces},
        .seen = t->seen,
        .seen_depth = t->seen_depth,
        .hit_depth = t->hit_depth,
        .normal = t->normal,
        .shape = t->shape,
        .border = t->border,
        .ends = t->ends,
        .colour = t->colour,
        .coverage = t->coverage,
        .light_st = t->light_st,
        .curvature = t->curvature,
        .light_change = t->light_change,
    };
    return b;
}

static struct native_list *list_of(const struct native_drawing *d, enum native_list_of which)
{
    return &d->target->list[which];
}

/* --- edges */

/* Number of rays along a side of a pixel (shaders/rounded.glsl). */
static int rounded_side(uint32_t n_listed, uint32_t max_rounded)
{
    return n_listed <= max_rounded        ? 4
           : n_listed <= 4 * max_rounded  ? 2
           : n_listed <= 16 * max_rounded ? 1
                                          : 0;
}

static bool meet_rounded(const struct native_drawing *d, struct error *error)
{
    struct native_target *t = d->target;
    const struct native_list *listed = list_of(d, NATIVE_ROUNDED);
    struct native_rounded rounded = {.pixel = listed->at.words, .n = listed->n};
    rounded.side = rounded_side(listed->n, tile_max_rounded(&d->place));
    if (!native_target_reserve_hits(t, (size_t)rounded.n * (size_t)(rounded.side * rounded.side),
                                    error))
        return false;
    /* The list of edges found is no longer needed. */
    native_sort_pixels(listed->at.words, listed->n, &d->place,
                       list_of(d, NATIVE_FOUND_EDGES)->at.words);
    rounded.hit = (float(*)[HIT_WORDS])(void *)t->hits;
    return native_meet_rounded(d->device, &rounded, error);
}

bool native_edges(const struct native_drawing *d, struct error *error)
{
    const struct native_programs *programs = native_device_programs(d->device);
    struct native_target *t = d->target;
    struct native_bindings b = native_bindings_of(d);
    b.groups = list_of(d, NATIVE_GROUPS);
    b.rims = list_of(d, NATIVE_RIMS);
    b.edges = list_of(d, NATIVE_FOUND_EDGES);
    b.rounded = list_of(d, NATIVE_ROUNDED);
    const int32_t shaded[4] = {(int32_t)d->inside.x, (int32_t)d->inside.y, (int32_t)d->inside.width,
                               (int32_t)d->inside.height};
    memcpy(b.shaded, shaded, sizeof shaded);
    for (int i = NATIVE_RIMS; i < NATIVE_LISTS; i++)
        t->list[i].n = 0;
    memset(t->coverage.words, 0, (size_t)t->width * t->height * sizeof(float));
    run_program(d, programs->edges_find, &b, b.groups->n, GROUPS_PER_WORKGROUP, NULL);

    b = native_bindings_of(d);
    b.listed = list_of(d, NATIVE_RIMS);
    run_program(d, programs->ends_find, &b, b.listed->n, LISTED_PER_WORKGROUP, NULL);

    b.listed = list_of(d, NATIVE_FOUND_EDGES);
    b.edges = list_of(d, NATIVE_EDGES);
    b.rounded = list_of(d, NATIVE_ROUNDED);
    run_program(d, programs->edges_recheck, &b, b.listed->n, EDGES_PER_WORKGROUP, NULL);
    return meet_rounded(d, error);
}

/* --- lights */

static uint8_t byte_of(float a)
{
    return (uint8_t)lrintf(255 * fminf(fmaxf(a, 0), 1));
}

/* Pixels outside the groups show no surface. */
struct cleared {
    const struct native_target *target;
    uint32_t colour, planes;
};

static void fill_words(const struct native_image *image, uint32_t first, uint32_t end,
                       uint32_t word)
{
    size_t width = (size_t)image->width;
    for (int channel = 0; channel < image->channels; channel++) {
        uint32_t *words = image->words + (size_t)channel * image->channel_words;
        for (size_t i = first * width; i < end * width; i++)
            words[i] = word;
    }
}

static void clear_rows(void *owner, uint32_t first, uint32_t end)
{
    static const uint32_t NAN_WORD = 0x7fc00000;
    const struct cleared *cleared = owner;
    const struct native_target *t = cleared->target;
    fill_words(&t->colour, first, end, cleared->colour);
    if (cleared->planes & PLANE_LIGHT)
        fill_words(&t->light_st, first, end, NAN_WORD);
    if (cleared->planes & PLANE_CURVATURE)
        fill_words(&t->curvature, first, end, NAN_WORD);
    if (cleared->planes & PLANE_LIGHT_CHANGE)
        fill_words(&t->light_change, first, end, NAN_WORD);
}

static void clear_planes(const struct native_drawing *d)
{
    const struct frame_request *request = d->request;
    struct cleared cleared = {d->target, 0, request->planes};
    /* The same rule as in shaders/shown.glsl: a clear colour is 0. */
    for (int k = 0; k < 4 && !(request->empty[3] < 0.5f / 255); k++)
        cleared.colour |= (uint32_t)byte_of(request->empty[k]) << (8 * k);
    native_device_rows(d->device, d->target->height, clear_rows, &cleared);
}

static struct native_picture picture_of(const struct frame_request *request,
                                        const struct light *light)
{
    const struct native_light_image *image =
        (const struct native_light_image *)(const void *)light->pattern.image;
    if (light->pattern.kind != PATTERN_IMAGE || !image)
        return (struct native_picture){0};
    struct native_picture picture = image->picture;
    picture.repeats_s = light_image_repeats_s(request, light);
    picture.repeats_t = light_image_repeats_t(request, light);
    return picture;
}

/* Shades again the pixels that the programs for edges have listed. */
static void shade_listed(const struct native_drawing *d, struct native_bindings *b)
{
    const struct native_programs *programs = native_device_programs(d->device);
    b->listed = list_of(d, NATIVE_EDGES);
    run_program(d, programs->edges_shade, b, b->listed->n, EDGES_PER_WORKGROUP, NULL);
    b->listed = list_of(d, NATIVE_ROUNDED);
    b->max_rounded = tile_max_rounded(&d->place);
    run_program(d, programs->rounded_shade, b, b->listed->n, LISTED_PER_WORKGROUP, NULL);
}

/* Counts in a list that the programs for edges no longer need. */
static void count_light(const struct native_drawing *d, struct native_bindings *b,
                        struct native_share *share)
{
    const struct tile *in = &d->inside;
    const int32_t inside[4] = {(int32_t)in->x, (int32_t)in->y, (int32_t)in->width,
                               (int32_t)in->height};
    memcpy(b->inside, inside, sizeof inside);
    b->stride = tiles_share_stride(d->request->width_px, d->request->height_px);
    share->seen_px = share->met_px = 0;
    share->met = list_of(d, NATIVE_FOUND_EDGES)->at;
    run_program(d, native_device_programs(d->device)->share, b, b->groups->n, GROUPS_PER_WORKGROUP,
                share);
}

/* Bindings for light i of those shown, over those behind it. Fills the block, which the bindings refer to. */
static struct native_bindings bindings_of_light(const struct native_drawing *d, uint32_t i,
                                                struct light_block *block)
{
    const struct frame_request *request = d->request;
    const struct light *light = &request->lights[i];
    const struct native_target *t = d->target;
    struct native_bindings b = native_bindings_of(d);
    light_block_fill(block, request, i);
    b.Light = block;
    b.line_family = (int32_t)request->lines.family;
    b.light_kind = (int32_t)light->kind;
    b.pattern_kind = (int32_t)light->pattern.kind;
    b.is_soft = light->pattern.soft > 0;
    b.is_filtered = !request->unfiltered;
    b.picture = picture_of(request, light);
    b.next_light = t->lights[i & 1];
    b.next_missed = t->missed[i & 1];
    b.next_uneven = t->uneven[i & 1];
    b.behind_light = t->lights[~i & 1];
    b.behind_missed = t->missed[~i & 1];
    b.behind_uneven = t->uneven[~i & 1];
    b.square_sum = t->square_sum;
    return b;
}

/* The pass of the foremost light also lists the pixels to shade in parts. */
static void shade_light(const struct native_drawing *d, uint32_t i, struct native_share *share)
{
    const struct frame_request *request = d->request;
    const struct native_programs *programs = native_device_programs(d->device);
    const struct native_target *t = d->target;
    struct light_block block;
    struct native_array hits = {t->hits, (uint32_t)(t->n_hit_words / HIT_WORDS)};
    struct native_bindings b = bindings_of_light(d, i, &block);
    b.RoundedHits = &hits;
    b.groups = list_of(d, NATIVE_SHADED_GROUPS);
    b.parts = list_of(d, NATIVE_PARTS);
    run_program(d, programs->shade, &b, b.groups->n, GROUPS_PER_WORKGROUP, NULL);
    b.parts = NULL;
    if (request_has_coverage(request))
        shade_listed(d, &b);
    if (request_may_miss_light(request))
        count_light(d, &b, share);
    if (i == 0 && request->planes & (PLANE_LIGHT | PLANE_CURVATURE | PLANE_LIGHT_CHANGE))
        run_program(d, programs->shade_planes, &b, b.groups->n, GROUPS_PER_WORKGROUP, NULL);
}

/* Number of squares of a pixel that are shaded separately (shaders/high_curvature_shade.comp.glsl). */
enum { SQUARES = 9 };

/* Shades some squares of the pixels that are shaded in parts. */
static void shade_squares(const struct native_drawing *d, struct native_bindings *b, uint32_t first,
                          uint32_t end)
{
    b->listed = list_of(d, NATIVE_PARTS);
    b->first_square = first;
    b->end_square = end;
    run_program(d, native_device_programs(d->device)->high_curvature_shade, b, b->listed->n,
                LISTED_PER_WORKGROUP, NULL);
}

/* Shades them again, square by square with all lights of each; a single light shades all squares at once. */
static void shade_parts(const struct native_drawing *d)
{
    uint32_t n_lights = d->request->n_lights, at_once = n_lights > 1 ? 1 : SQUARES;
    for (uint32_t first = 0; first < SQUARES && list_of(d, NATIVE_PARTS)->n; first += at_once)
        for (uint32_t i = n_lights; i-- > 0;) {
            struct light_block block;
            struct native_bindings b = bindings_of_light(d, i, &block);
            shade_squares(d, &b, first, first + at_once);
        }
}

bool native_shade(const struct native_drawing *d, const struct frame_watch *watch,
                  struct frame *frame, struct error *error)
{
    const struct frame_request *request = d->request;
    bool any_seen = native_any_seen(d->target);
    struct native_share share = {.seen_px = any_seen, .met_px = any_seen};
    clear_planes(d);
    list_of(d, NATIVE_PARTS)->n = 0;
    for (uint32_t i = request->n_lights; i-- > 0;) {
        if (!frame_watch_check(watch, error))
            return false;
        shade_light(d, i, &share);
    }
    shade_parts(d);
    if (request->count_light) {
        frame->seen_px += share.seen_px;
        frame->met_px += share.met_px;
    }
    return true;
}
