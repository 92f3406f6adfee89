/* The programs that are kept on the device: frames hold what they wait for, each program runs first in
 * a step of its own, and no more are kept than there is room for. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "server/render/gl/device_internal.h"
#include "server/render/gl/frame_state.h"
#include "server/render/gl/model.h"
#include "server/render/gl/context/quirks.h"
#include "tests/unit/request_scene.h"

static const char tetrahedron[] = "v 1 1 1\nv -1 -1 1\nv -1 1 -1\nv 1 -1 -1\n"
                                  "f 1 3 2\nf 1 4 3\nf 1 2 4\nf 2 3 4\n";

static void scene_init(struct scene *scene, const char *text)
{
    scene_open(scene, text, 48, 40, false);
}

static enum frame_step step(struct scene *scene, struct frame_work *work, struct frame *frame)
{
    struct error error = {0};
    enum frame_step step = renderer_step(scene->renderer, scene->model, work, frame, &error);
    if (step == FRAME_FAILED)
        fail_msg("%s", error.text);
    return step;
}

/* Draws one frame of one tile. Returns how many steps made a program. */
static unsigned draw(struct scene *scene, struct frame_work *work, struct frame *frame)
{
    struct error error = {0};
    unsigned n_programs = 0;
    enum frame_step next;
    assert_true(renderer_begin(scene->renderer, work, frame, &error));
    while ((next = step(scene, work, frame)) == FRAME_MORE) {
        assert_false(work->has_drawn);
        n_programs++;
    }
    assert_int_equal(next, FRAME_DONE);
    return n_programs;
}

static unsigned draw_anew(struct scene *scene, const struct frame_request *request)
{
    struct frame frame;
    struct frame_work work = {.request = request};
    unsigned n_programs = draw(scene, &work, &frame);
    frame_finish(&frame);
    return n_programs;
}

/* Each program of a frame takes one step, once; other frames are drawn between these steps. */
static void test_one_a_step(void **state)
{
    (void)state;
    struct scene scene;
    scene_init(&scene, tetrahedron);
    struct frame_request usual = scene.request, other = scene.request;
    assert_int_equal(draw_anew(&scene, &usual), 4);
    assert_int_equal(draw_anew(&scene, &usual), 0);
    usual.width_px = usual.height_px =
        64; /* drivers compile a variant of their own for sizes that are powers of two */
    assert_int_equal(draw_anew(&scene, &usual), 0);
    assert_int_equal(gl_renderer_of(scene.renderer)->target.width, 65);
    other.lights[0].pattern.kind = PATTERN_CIRCLES;
    other.planes |= PLANE_CURVATURE;
    struct error error = {0};
    struct frame frame, alone;
    struct frame_work work = {.request = &other};
    assert_true(renderer_begin(scene.renderer, &work, &frame, &error));
    for (int k = 0; k < 5; k++) {
        assert_int_equal(step(&scene, &work, &frame), FRAME_MORE);
        assert_false(work.has_drawn);
        assert_int_equal(draw_anew(&scene, &usual), 0);
    }
    assert_int_equal(step(&scene, &work, &frame), FRAME_DONE);
    struct frame_work again = {.request = &other};
    assert_int_equal(draw(&scene, &again, &alone), 0);
    assert_memory_equal(frame.plane[0], alone.plane[0], (size_t)48 * 40 * 4);
    frame_finish(&frame);
    frame_finish(&alone);
    scene_finish(&scene);
}

/* Soft edges need programs of their own, except for a rainbow, which they do not change. */
static void test_soft(void **state)
{
    (void)state;
    struct scene scene;
    scene_init(&scene, tetrahedron);
    struct frame_request request = scene.request;
    struct pattern *pattern = &request.lights[0].pattern;
    pattern->kind = PATTERN_RAINBOW;
    assert_int_equal(draw_anew(&scene, &request), 4);
    pattern->soft = 0.5;
    assert_int_equal(draw_anew(&scene, &request), 0);
    pattern->kind = PATTERN_DISTANCE;
    assert_int_equal(draw_anew(&scene, &request), 4);
    pattern->soft = 0;
    assert_int_equal(draw_anew(&scene, &request), 4);
    scene_finish(&scene);
}

/* How many programs the context has. Counting kept names would not do: a name may belong to another
 * program by now. */
static int count_programs(void)
{
    int n = 0;
    for (GLuint name = 1; name < 10000; name++)
        n += glIsProgram(name);
    return n;
}

/* The i-th of many programs. */
static struct program_id numbered(int i)
{
    return (struct program_id){.set = SET_SHADING,
                               .shading = {.family = (uint8_t)(i / 28),
                                           .light = (uint8_t)(i / 7 % 4),
                                           .pattern = (uint8_t)(i % 7),
                                           .which = SHADED_PLANES}};
}

/* Takes the next order and fulfils it, as the maker does. Returns its pattern; -1: no order. */
static int make_next(struct kept_programs *programs, GLuint name)
{
    struct program_id id;
    struct error error;
    int at;
    error_set(&error, ERROR_DEVICE, "the driver fails");
    if (!kept_programs_take_order(programs, &id, &at))
        return -1;
    kept_programs_finish_order(programs, at, name, &error);
    return id.shading.pattern;
}

/* Holds `n` programs from the first on, and makes empty programs for those that are missing. */
static void hold(struct kept_programs *programs, struct program_hold *held, int first, int n)
{
    struct error error = {0};
    struct program_id ids[MAX_FRAME_PROGRAMS];
    for (int i = 0; i < n; i++)
        ids[i] = numbered(first + i);
    while (kept_programs_hold(programs, held, ids, n, 1, &error) != HOLD_READY) {
        assert_non_null(held->programs);
        make_next(programs, glCreateProgram());
    }
}

/* If there is no room left, the program that was used longest ago is removed, but none that a frame
 * holds. */
static void test_room(void **state)
{
    (void)state;
    enum { HALF = MAX_KEPT_PROGRAMS / 2 };
    struct scene scene;
    scene_init(&scene, tetrahedron);
    struct kept_programs *programs = kept_programs_create(NULL, NULL);
    struct program_hold held = {0}, other = {0};
    hold(programs, &held, 0, HALF);
    program_hold_end(&held);
    hold(programs, &held, HALF, HALF);
    program_hold_end(&held);
    int n = count_programs();
    hold(programs, &held, 0, 1); /* now the first is the one used last */
    program_hold_end(&held);
    hold(programs, &held, 1, 1);
    hold(programs, &other, 2 * HALF, HALF);
    program_hold_end(&other);
    assert_int_equal(count_programs(), n);
    for (int i = 0; i < 3 * HALF; i++) {
        const struct program_id id = numbered(i);
        bool is_kept = kept_programs_find(programs, &id, NULL) != 0;
        if (is_kept != (i < 2 || i >= HALF + 2))
            fail_msg("program %d", i);
    }
    program_hold_end(&held);
    kept_programs_release(programs);
    scene_finish(&scene);
}

/* What the budget has no room for goes, the program used longest ago first, but none that a frame holds. */
static void test_drop(void **state)
{
    (void)state;
    struct scene scene;
    scene_init(&scene, tetrahedron);
    struct kept_programs *programs = kept_programs_create(NULL, NULL);
    struct program_hold held = {0}, other = {0};
    hold(programs, &held, 0, 6);
    hold(programs, &other, 6, 6);
    program_hold_end(&other);
    hold(programs, &other, 8, 1); /* now the one used last */
    program_hold_end(&other);
    int n = count_programs();
    kept_programs_drop(programs, 12);
    assert_int_equal(kept_programs_count(programs), 12);
    kept_programs_drop(programs, 7);
    assert_int_equal(count_programs(), n - 5);
    for (int i = 0; i < 12; i++) {
        const struct program_id id = numbered(i);
        if ((kept_programs_find(programs, &id, NULL) != 0) != (i < 6 || i == 8))
            fail_msg("program %d", i);
    }
    kept_programs_drop(programs, 0);
    assert_int_equal(kept_programs_count(programs), 6);
    program_hold_end(&held);
    kept_programs_drop(programs, 0);
    assert_int_equal(kept_programs_count(programs), 0);
    hold(programs, &held, 0, 6); /* made again */
    program_hold_end(&held);
    kept_programs_release(programs);
    scene_finish(&scene);
}

/* A frame for whose programs there is no room, because other frames hold theirs, waits until one of
 * these is drawn or given up. */
static void test_full(void **state)
{
    (void)state;
    struct scene scene;
    struct error error = {0};
    scene_init(&scene, tetrahedron);
    struct kept_programs *programs = kept_programs_create(NULL, NULL);
    struct program_hold first = {0}, second = {0}, third = {0};
    const struct program_id one_more = numbered(MAX_KEPT_PROGRAMS);
    hold(programs, &first, 0, MAX_KEPT_PROGRAMS - MAX_FRAME_PROGRAMS);
    hold(programs, &second, MAX_KEPT_PROGRAMS - MAX_FRAME_PROGRAMS, MAX_FRAME_PROGRAMS);
    assert_int_equal(kept_programs_hold(programs, &third, &one_more, 1, 1, &error), HOLD_WAITS);
    assert_null(third.programs);
    program_hold_end(&first);
    kept_programs_wait(programs);
    hold(programs, &third, MAX_KEPT_PROGRAMS, 1);
    for (int i = MAX_KEPT_PROGRAMS - MAX_FRAME_PROGRAMS; i <= MAX_KEPT_PROGRAMS; i++) {
        const struct program_id id = numbered(i);
        assert_true(kept_programs_find(programs, &id, NULL));
    }
    program_hold_end(&second);
    program_hold_end(&third);
    kept_programs_release(programs);
    scene_finish(&scene);
}

static void count_wake(void *owner)
{
    ++*(int *)owner;
}

/* Programs are made in turns for those who ask, then ahead of use; not for frames that are given
 * up; and a failure is told to all who wait, once. The list alone, without a device. */
static void test_orders(void **state)
{
    (void)state;
    int wakes = 0;
    struct error error = {0};
    struct kept_programs *programs = kept_programs_create(count_wake, &wakes);
    const struct program_id greedy[] = {numbered(0), numbered(1), numbered(2)}, small = numbered(3),
                            ahead = numbered(4), given_up = numbered(5);
    struct program_hold a = {0}, b = {0}, c = {0};
    kept_programs_order(programs, &ahead);
    assert_int_equal(kept_programs_hold(programs, &a, greedy, 3, 1, &error), HOLD_WAITS);
    assert_int_equal(kept_programs_hold(programs, &b, &small, 1, 2, &error), HOLD_WAITS);
    assert_int_equal(kept_programs_hold(programs, &c, &given_up, 1, 3, &error), HOLD_WAITS);
    program_hold_end(&c);
    const int order[] = {0, 3, 1, 2, 4};
    for (GLuint i = 0; i < 5; i++) {
        assert_int_equal(make_next(programs, 100 + i), order[i]);
        assert_int_equal(wakes, i + 1);
    }
    assert_int_equal(kept_programs_hold(programs, &a, greedy, 3, 1, &error), HOLD_READY);
    assert_int_equal(kept_programs_hold(programs, &b, &small, 1, 2, &error), HOLD_READY);
    assert_int_equal(kept_programs_count(programs), 5);
    program_hold_end(&a);
    program_hold_end(&b);

    assert_int_equal(kept_programs_hold(programs, &a, &given_up, 1, 1, &error), HOLD_WAITS);
    assert_int_equal(kept_programs_hold(programs, &b, &given_up, 1, 2, &error), HOLD_WAITS);
    assert_int_equal(make_next(programs, 0), 5);
    assert_int_equal(kept_programs_hold(programs, &a, &given_up, 1, 1, &error), HOLD_FAILED);
    assert_int_equal(kept_programs_hold(programs, &b, &given_up, 1, 2, &error), HOLD_FAILED);
    assert_string_equal(error.text, "the driver fails");
    assert_int_equal(kept_programs_hold(programs, &b, &given_up, 1, 2, &error), HOLD_WAITS);
    assert_int_equal(make_next(programs, 200), 5);
    assert_int_equal(kept_programs_hold(programs, &b, &given_up, 1, 2, &error), HOLD_READY);
    kept_programs_forget(programs); /* the device is lost: what is held is made again */
    assert_int_equal(kept_programs_hold(programs, &b, &given_up, 1, 2, &error), HOLD_WAITS);
    assert_int_equal(make_next(programs, 201), 5);
    assert_int_equal(kept_programs_count(programs), 1);
    kept_programs_close(programs);
    assert_int_equal(make_next(programs, 0), -1);
    wakes = 0;
    kept_programs_release(programs); /* a frame may outlive the renderer */
    program_hold_end(&b);
    assert_int_equal(wakes, 0);
}

/* Models whose tables are divided in the same way share their programs. */
static void test_layouts(void **state)
{
    (void)state;
    struct scene scene;
    struct program_id ids[4][TABLE_PROGRAMS];
    scene_init(&scene, tetrahedron);
    const struct gl_renderer *r = gl_renderer_of(scene.renderer);
    struct gl_model model = {.points.n = 1, .nodes.n = 1, .adjacency.n = 1};
    gl_model_programs(r, &model, false, ids[0]);
    gl_model_programs(r, gl_model_of(scene.model), false, ids[1]);
    gl_model_programs(r, &model, true, ids[2]);
    model.points.n = 2;
    gl_model_programs(r, &model, false, ids[3]);
    for (int which = 0; which < TABLE_PROGRAMS; which++) {
        assert_true(program_id_is_same(&ids[0][which], &ids[1][which]));
        assert_false(program_id_is_same(&ids[0][which], &ids[2][which]));
        assert_false(program_id_is_same(&ids[0][which], &ids[3][which]));
        assert_false(program_id_is_same(&ids[0][which], &ids[0][(which + 1) % TABLE_PROGRAMS]));
    }
    scene_finish(&scene);
}

/* Drivers also compile variants for buffer textures whose sizes are powers of two. */
static void test_no_powers_of_two(void **state)
{
    (void)state;
    static const size_t sizes[][2] = {{0, 3}, {1, 3}, {3, 3}, {4, 5}, {64, 65}, {65, 65}};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++)
        assert_int_equal(no_power_of_two(sizes[i][0]), sizes[i][1]);
    struct scene scene; /* one face: one texel of adjacency */
    scene_init(&scene, "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
    draw_anew(&scene, &scene.request);
    const struct gl_model *model = gl_model_of(scene.model);
    const GLuint buffers[] = {model->points.buffer[0], model->nodes.buffer[0],
                              model->adjacency.buffer[0],
                              gl_renderer_of(scene.renderer)->visibility.grid_buffer};
    for (size_t i = 0; i < sizeof buffers / sizeof buffers[0]; i++) {
        GLint64 bytes;
        glGetNamedBufferParameteri64v(buffers[i], GL_BUFFER_SIZE, &bytes);
        assert_true(bytes & (bytes - 1));
    }
    scene_finish(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_one_a_step), cmocka_unit_test(test_soft),
        cmocka_unit_test(test_orders),     cmocka_unit_test(test_room),
        cmocka_unit_test(test_drop),       cmocka_unit_test(test_full),
        cmocka_unit_test(test_layouts),    cmocka_unit_test(test_no_powers_of_two),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
