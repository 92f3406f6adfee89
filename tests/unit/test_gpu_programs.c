/* The programs that are kept on the device: one is made in each step, and no more are kept than
 * there is room for. */
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

/* Frames that take turns cannot prevent each other from being drawn. */
static void test_ends(void **state)
{
    (void)state;
    struct scene scene;
    scene_init(&scene, tetrahedron);
    struct error error = {0};
    struct frame frame;
    struct frame_work work = {.request = &scene.request};
    assert_true(renderer_begin(scene.renderer, &work, &frame, &error));
    /* the other frames have removed all of its programs */
    gl_frame_of(&work)->n_programs = MAX_FRAME_PROGRAMS;
    assert_int_equal(step(&scene, &work, &frame), FRAME_DONE);
    frame_finish(&frame);
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

/* The key of the i-th of many programs that compile quickly. */
static struct shade_key key(int i)
{
    return (struct shade_key){.family = (uint8_t)(i / 28),
                              .light = (uint8_t)(i / 7 % 4),
                              .pattern = (uint8_t)(i % 7),
                              .which = SHADED_PLANES};
}

/* If there is no room left, the program that was used longest ago is removed. */
static void test_room(void **state)
{
    (void)state;
    struct scene scene;
    struct error error = {0};
    static struct shade_programs programs;
    scene_init(&scene, tetrahedron);
    programs = (struct shade_programs){0};
    shade_programs_begin(&programs);
    for (int i = 0; i < MAX_SHADE_PROGRAMS; i++) {
        assert_null(shade_programs_find(&programs, key(i)));
        if (!shade_programs_compile(&programs, key(i), &error))
            fail_msg("%s", error.text);
        if (i == 2)
            shade_programs_begin(&programs);
    }
    shade_programs_begin(&programs);
    assert_non_null(shade_programs_find(&programs, key(0)));
    int n = count_programs();
    assert_non_null(shade_programs_compile(&programs, key(MAX_SHADE_PROGRAMS), &error));
    assert_non_null(shade_programs_compile(&programs, key(MAX_SHADE_PROGRAMS + 1), &error));
    for (int i = 0; i < MAX_SHADE_PROGRAMS + 2; i++)
        assert_int_equal(shade_programs_find(&programs, key(i)) == NULL, i == 1 || i == 2);
    assert_int_equal(count_programs(), n);
    scene_finish(&scene);
}

/* Models of any number of different sizes are drawn, and the programs used last are kept. */
static void test_table_sets(void **state)
{
    (void)state;
    struct scene scene;
    struct error error = {0};
    struct gl_model model = {.points.n = 1, .nodes.n = 1, .adjacency.n = 1};
    scene_init(&scene, tetrahedron);
    GLuint first = programs_of(gl_renderer_of(scene.renderer), &model, false, &error)->evaluate;
    for (model.points.n = 2; model.points.n <= MAX_PROGRAM_SETS; model.points.n++)
        assert_non_null(programs_of(gl_renderer_of(scene.renderer), &model, false, &error));
    model.points.n = 1;
    assert_int_equal(programs_of(gl_renderer_of(scene.renderer), &model, false, &error)->evaluate,
                     first);
    int n = count_programs();
    for (int k = 1; k <= 2; k++) {
        model.points.n = MAX_PROGRAM_SETS + k;
        if (!programs_of(gl_renderer_of(scene.renderer), &model, k == 1, &error))
            fail_msg("%s", error.text);
    }
    assert_int_equal(count_programs(), n);
    model.points.n = 1; /* this program was used after the others */
    assert_int_equal(programs_of(gl_renderer_of(scene.renderer), &model, false, &error)->evaluate,
                     first);
    assert_int_equal(draw_anew(&scene, &scene.request), 4);
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
        cmocka_unit_test(test_ends),       cmocka_unit_test(test_room),
        cmocka_unit_test(test_table_sets), cmocka_unit_test(test_no_powers_of_two),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
