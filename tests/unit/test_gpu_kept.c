/* Planes that are kept from one frame to the next: which frames may use them, and that no frame
 * uses those of another. Each frame is compared with one of a new renderer, which has kept
 * nothing. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/render/gl/device_internal.h"
#include "tests/unit/renderer_frames.h"

enum { ALL_PLANES = (1 << PLANE_COUNT) - 1, MOST_TILES = 64 };

/* How a frame is cut: into one tile, into tiles whose planes are kept, into tiles whose planes are
 * not. */
enum cut { WHOLE, IN_PLACE, APART, N_CUTS };

static struct frame_work work_for(const struct frame_request *request, enum cut cut)
{
    return (struct frame_work){
        .request = request, .tile_px = cut == WHOLE ? 0 : 1, .in_place = cut == IN_PLACE};
}

static enum frame_step step(struct renderer *renderer, struct renderer_model *model,
                            struct frame_work *work, struct frame *frame)
{
    struct error error = {0};
    enum frame_step next;
    do
        next = renderer_step(renderer, model, work, frame, &error);
    while (next == FRAME_MORE && !work->has_drawn);
    if (next != FRAME_MORE && next != FRAME_DONE)
        fail_msg("%s", error.text);
    return next;
}

static struct frame begin(struct renderer *renderer, struct frame_work *work)
{
    struct error error = {0};
    struct frame frame;
    if (!renderer_begin(renderer, work, &frame, &error))
        fail_msg("%s", error.text);
    return frame;
}

static struct frame draw(struct renderer *renderer, struct renderer_model *model,
                         const struct frame_request *request, enum cut cut)
{
    struct frame_work work = work_for(request, cut);
    struct frame frame = begin(renderer, &work);
    while (step(renderer, model, &work, &frame) == FRAME_MORE)
        ;
    return frame;
}

static struct frame draw_fresh(const struct limit_tables *tables,
                               const struct frame_request *request, enum cut cut)
{
    struct renderer *renderer = open_renderer(0);
    struct renderer_model *model = upload(renderer, tables);
    struct frame frame = draw(renderer, model, request, cut);
    assert_true(frame.times.visibility_us > 0 && frame.times.evaluate_us > 0);
    renderer_model_destroy(renderer, model);
    renderer_destroy(renderer);
    return frame;
}

static bool is_reused(const struct frame *frame)
{
    assert_int_equal(frame->times.visibility_us == 0, frame->times.evaluate_us == 0);
    return frame->times.evaluate_us == 0;
}

static struct frame_request request_of_all(const struct limit_tables *tables, uint32_t width,
                                           uint32_t height)
{
    struct frame_request request = request_for(tables, width, height);
    request.planes = ALL_PLANES;
    return request;
}

/* Cut in place, a frame has the same bytes as in one piece: at silhouettes, creases, roundings of
 * about half a pixel, borders and places without a normal. That holds also if another such frame is
 * drawn between its tiles. */
static void test_cut_in_place(void **state)
{
    (void)state;
    static const char *const files[] = {"body", "creases", "pole", "ngons"};
    static const uint32_t sizes[][2] = {{333, 217}, {100, 900}, {701, 130}, {512, 384}};
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        char path[64];
        struct limit_tables tables;
        snprintf(path, sizeof path, "tests/models/%s.obj", files[i]);
        build_file(path, &tables);
        struct frame_request request = request_of_all(&tables, sizes[i][0], sizes[i][1]);
        struct frame_request other = request_of_all(&tables, 300, 300);
        struct frame whole = draw_fresh(&tables, &request, WHOLE);
        struct frame cut = draw_fresh(&tables, &request, IN_PLACE);
        assert_same_frames(&whole, &cut);
        frame_finish(&cut);
        struct renderer *renderer = open_renderer(0);
        struct renderer_model *model = upload(renderer, &tables);
        struct frame_work work = work_for(&request, IN_PLACE), between = work_for(&other, IN_PLACE);
        struct frame frame = begin(renderer, &work), other_frame = begin(renderer, &between);
        bool is_done = false;
        while (step(renderer, model, &work, &frame) == FRAME_MORE)
            is_done = is_done || step(renderer, model, &between, &other_frame) == FRAME_DONE;
        assert_same_frames(&whole, &frame);
        frame_work_finish(&between);
        frame_finish(&frame);
        frame_finish(&other_frame);
        renderer_model_destroy(renderer, model);
        renderer_destroy(renderer);
        frame_finish(&whole);
        limit_tables_finish(&tables);
    }
}

/* However a view was cut when it was first drawn, its next frame runs stage 3 only, and has the
 * bytes of a new renderer's frame. */
static void test_serves_every_cut(void **state)
{
    (void)state;
    struct limit_tables tables;
    build_file("tests/models/creases.obj", &tables);
    struct frame_request request = request_of_all(&tables, 300, 200), relit = request;
    relit.lights[0].pattern.count = 17;
    relit.planes = ALL_PLANES & ~PLANE_PTEX;
    struct frame fresh = draw_fresh(&tables, &relit, WHOLE);
    for (int first = WHOLE; first <= IN_PLACE; first++) {
        for (int second = WHOLE; second <= IN_PLACE; second++) {
            struct renderer *renderer = open_renderer(0);
            struct renderer_model *model = upload(renderer, &tables);
            struct frame before = draw(renderer, model, &request, (enum cut)first);
            struct frame after = draw(renderer, model, &relit, (enum cut)second);
            assert_false(is_reused(&before));
            assert_true(is_reused(&after));
            assert_same_frames(&fresh, &after);
            /* What tiles are drawn into is only as wide as a tile. */
            if (frames_device == &gl_device)
                assert_true(gl_renderer_of(renderer)->resting[PLANES_APART].target.width <
                            request.width_px);
            frame_finish(&before);
            frame_finish(&after);
            renderer_model_destroy(renderer, model);
            renderer_destroy(renderer);
        }
    }
    frame_finish(&fresh);
    limit_tables_finish(&tables);
}

/* A thumbnail between two frames of a view does not remove the view's kept planes. A frame of 4,096
 * pixels is too large for a thumbnail. */
static void test_small_frames(void **state)
{
    (void)state;
    struct limit_tables tables;
    build_file("tests/models/body.obj", &tables);
    struct renderer *renderer = open_renderer(0);
    struct renderer_model *model = upload(renderer, &tables);
    struct frame_request view = request_of_all(&tables, 320, 200);
    struct frame before = draw(renderer, model, &view, WHOLE);
    for (uint32_t height = 63; height <= 64; height++) {
        struct frame_request small = request_of_all(&tables, 64, height);
        for (int k = 0; k < 2; k++) {
            struct frame thumbnail = draw(renderer, model, &small, WHOLE);
            assert_int_equal(is_reused(&thumbnail), k == 1);
            frame_finish(&thumbnail);
        }
        struct frame again = draw(renderer, model, &view, WHOLE);
        assert_int_equal(is_reused(&again), height == 63);
        assert_same_frames(&before, &again);
        frame_finish(&again);
    }
    frame_finish(&before);
    renderer_model_destroy(renderer, model);
    renderer_destroy(renderer);
    limit_tables_finish(&tables);
}

/* --- random sequences */

enum { N_CAGES = 2, N_VIEWS = 4, N_REQUESTS = N_CAGES * N_VIEWS, N_UNDER_WAY = 3, N_TURNS = 400 };

struct sequence {
    struct limit_tables tables[N_CAGES];
    struct frame_request request[N_REQUESTS][2]; /* under the first light, and under another */
    struct frame fresh[N_REQUESTS][2][N_CUTS];   /* filled at the first comparison */
    struct renderer *renderer;
    struct renderer_model *model[N_CAGES];
    struct frame_work work[N_UNDER_WAY];
    struct frame frame[N_UNDER_WAY];
    int drawn[N_UNDER_WAY], light[N_UNDER_WAY]; /* index of the request; -1: none */
    enum cut cut[N_UNDER_WAY];
    uint64_t random;
    unsigned n_compared, n_reused[N_CUTS];
};

static unsigned below(struct sequence *s, unsigned n)
{
    s->random ^= s->random << 13;
    s->random ^= s->random >> 7;
    s->random ^= s->random << 17;
    return (unsigned)((s->random >> 11) % n);
}

static void sequence_init(struct sequence *s)
{
    static const char *const files[N_CAGES] = {"tests/models/body.obj", "tests/models/creases.obj"};
    static const uint32_t sizes[N_VIEWS][2] = {{180, 150}, {180, 150}, {140, 290}, {40, 30}};
    *s = (struct sequence){.random = 88172645463325252u};
    for (int c = 0; c < N_CAGES; c++) {
        build_file(files[c], &s->tables[c]);
        for (int v = 0; v < N_VIEWS; v++) {
            struct frame_request *request = s->request[c * N_VIEWS + v];
            request[0] = request_of_all(&s->tables[c], sizes[v][0], sizes[v][1]);
            request[0].planes = v % 2 ? ALL_PLANES : PLANE_COLOUR | PLANE_NORMAL | PLANE_COVERAGE;
            if (v == 1)
                request[0].camera.fov_deg /= 2;
            request[1] = request[0];
            request[1].lights[0].pattern.kind = PATTERN_CIRCLES;
            request[1].unfiltered = v == 2;
            request[1].aliased = v == 1;
            request[1].planes = v == 2   ? PLANE_COLOUR | PLANE_PTEX
                                : v == 1 ? PLANE_COLOUR | PLANE_LIGHT
                                         : ALL_PLANES;
        }
    }
    /* Before the tested renderer is opened, because a thread has one context at a time. */
    for (int i = 0; i < N_REQUESTS * 4; i++)
        s->fresh[i / 4][i / 2 % 2][i % 2] = draw_fresh(
            &s->tables[i / 4 / N_VIEWS], &s->request[i / 4][i / 2 % 2], i % 2 ? APART : WHOLE);
    s->renderer = open_renderer(0);
    for (int c = 0; c < N_CAGES; c++)
        s->model[c] = upload(s->renderer, &s->tables[c]);
    for (int k = 0; k < N_UNDER_WAY; k++)
        s->drawn[k] = -1;
}

static void give_up(struct sequence *s, int k)
{
    if (s->drawn[k] >= 0) {
        frame_work_finish(&s->work[k]);
        frame_finish(&s->frame[k]);
    }
    s->drawn[k] = -1;
}

static void compare(struct sequence *s, int k)
{
    int i = s->drawn[k], light = s->light[k];
    enum cut cut = s->cut[k];
    const struct frame *fresh = &s->fresh[i][light][cut == APART];
    assert_same_frames(fresh, &s->frame[k]);
    assert_int_equal(fresh->shows_surface, s->frame[k].shows_surface);
    s->n_compared++;
    s->n_reused[cut] += is_reused(&s->frame[k]);
    give_up(s, k);
}

/* Begins a frame, continues one, gives one up, or replaces a model. */
static void turn(struct sequence *s)
{
    int k = (int)below(s, N_UNDER_WAY);
    unsigned what = below(s, 20);
    if (what == 0) {
        int c = (int)below(s, N_CAGES);
        for (int n = 0; n < N_UNDER_WAY; n++)
            if (s->drawn[n] >= 0 && s->drawn[n] / N_VIEWS == c)
                give_up(s, n);
        renderer_model_destroy(s->renderer, s->model[c]);
        s->model[c] = upload(s->renderer, &s->tables[c]);
    } else if (what == 1) {
        give_up(s, k);
    } else if (s->drawn[k] < 0) {
        /* Mostly a view of one model, so that there are planes to reuse. */
        int c = below(s, 3) == 0, v = (int)below(s, N_VIEWS);
        s->drawn[k] = c * N_VIEWS + v;
        s->light[k] = (int)below(s, 2);
        s->cut[k] = (enum cut)below(s, N_CUTS);
        s->work[k] = work_for(&s->request[s->drawn[k]][s->light[k]], s->cut[k]);
        s->frame[k] = begin(s->renderer, &s->work[k]);
    } else {
        /* Draws the frame to its end, or one tile more of it. */
        struct renderer_model *model = s->model[s->drawn[k] / N_VIEWS];
        bool to_end = below(s, 2);
        enum frame_step next;
        do
            next = step(s->renderer, model, &s->work[k], &s->frame[k]);
        while (to_end && next == FRAME_MORE);
        if (next == FRAME_DONE)
            compare(s, k);
    }
}

static void test_any_sequence(void **state)
{
    (void)state;
    static struct sequence s;
    sequence_init(&s);
    for (int n = 0; n < N_TURNS; n++)
        turn(&s);
    printf("%u frames compared; reused: %u as one, %u in place, %u apart\n", s.n_compared,
           s.n_reused[WHOLE], s.n_reused[IN_PLACE], s.n_reused[APART]);
    assert_true(s.n_compared > 80 && s.n_reused[WHOLE] > 5 && s.n_reused[IN_PLACE] > 5);
    for (int k = 0; k < N_UNDER_WAY; k++)
        give_up(&s, k);
    for (int i = 0; i < N_REQUESTS; i++)
        for (int light = 0; light < 2; light++)
            for (int cut = 0; cut < 2; cut++)
                frame_finish(&s.fresh[i][light][cut]);
    for (int c = 0; c < N_CAGES; c++) {
        renderer_model_destroy(s.renderer, s.model[c]);
        limit_tables_finish(&s.tables[c]);
    }
    renderer_destroy(s.renderer);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cut_in_place),
        cmocka_unit_test(test_serves_every_cut),
        cmocka_unit_test(test_small_frames),
        cmocka_unit_test(test_any_sequence),
    };
    int failed_on_gl = cmocka_run_group_tests_name("GL", tests, NULL, NULL);
    frames_device = &native_renderer_device;
    return failed_on_gl + cmocka_run_group_tests_name("native", tests, NULL, NULL);
}
