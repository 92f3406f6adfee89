/* Polygons: how their error falls from level to level, wireframes, what is kept between frames, and
 * how many polygons are too many. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "protocol/srgb.h"
#include "server/render/mesh.h"
#include "server/surface/evaluate.h"
#include "tests/unit/polygon_scene.h"

static struct frame render(struct scene *scene, const struct frame_request *request)
{
    struct error error = {0};
    struct frame frame;
    if (!renderer_render(scene->renderer, scene->model, request, &frame, &error))
        fail_msg("%s", error.text);
    return frame;
}

static struct frame render_surface(struct scene *scene, enum surface_kind kind, uint32_t level)
{
    struct frame_request request = request_for(scene);
    request.surface = (struct surface){kind, level};
    return render(scene, &request);
}

static const float *vec3_of(const struct frame *frame, int plane, size_t pixel)
{
    return (const float *)frame->plane[plane] + 3 * pixel;
}

static uint32_t face_of(const struct frame *frame, size_t pixel)
{
    return ((const uint32_t *)frame->plane[3])[3 * pixel];
}

/* Whether the surface is seen from well above. Near an outline a pixel's ray runs along the
 * surface, and meets the polygons far from the point where it meets the surface. */
static bool faces_eye(const struct frame *frame, size_t pixel, const double eye[3])
{
    const float *p = vec3_of(frame, 1, pixel), *n = vec3_of(frame, 2, pixel);
    double dot = 0, size = 0;
    for (int k = 0; k < 3; k++) {
        dot += ((double)p[k] - eye[k]) * (double)n[k];
        size = hypot(size, (double)p[k] - eye[k]);
    }
    return fabs(dot) > 0.5 * size;
}

/* The polygons' errors where both frames show the same Ptex face from well above. */
struct errors {
    /* the largest of position and normal, the mean of the curvatures */
    double normal_rad, place, curvature;
    size_t n, same, hit;
};

static struct errors compare(const struct frame *a, const struct frame *b, const double eye[3])
{
    struct errors e = {0};
    for (size_t k = 0; k < (size_t)a->width_px * a->height_px; k++) {
        e.hit += face_of(b, k) != UINT32_MAX;
        if (face_of(a, k) != face_of(b, k) || face_of(a, k) == UINT32_MAX)
            continue;
        e.same++;
        if (!faces_eye(b, k, eye))
            continue;
        const float *m = vec3_of(a, 2, k), *n = vec3_of(b, 2, k);
        const float *p = vec3_of(a, 1, k), *q = vec3_of(b, 1, k);
        const float *c = (const float *)a->plane[5] + 2 * k,
                    *d = (const float *)b->plane[5] + 2 * k;
        double chord =
            hypot(hypot((double)(m[0] - n[0]), (double)(m[1] - n[1])), (double)(m[2] - n[2]));
        double place =
            hypot(hypot((double)(p[0] - q[0]), (double)(p[1] - q[1])), (double)(p[2] - q[2]));
        e.normal_rad = fmax(e.normal_rad, 2 * asin(0.5 * chord));
        e.place = fmax(e.place, place);
        e.curvature += fabs((double)(c[0] - d[0])) + fabs((double)(c[1] - d[1]));
        e.n++;
    }
    e.curvature /= (double)e.n;
    return e;
}

/* Linear interpolation has an error of second order in normals and positions. The shape operator of
 * polygons has one of first order. */
static void test_error_falls(void **state)
{
    (void)state;
    struct scene scene;
    build_torus(12, &scene.tables);
    open_scene(&scene, 0);
    struct frame_request view = request_for(&scene);
    struct frame exact = render(&scene, &view);
    struct errors last = {0};
    for (uint32_t level = 0; level <= 5; level++) {
        struct frame frame = render_surface(&scene, SURFACE_POLYGON, level);
        struct errors e = compare(&frame, &exact, view.camera.eye);
        printf("level %u: normal %.2e rad, place %.2e, curvature %.2e, %zu of %zu pixels\n", level,
               e.normal_rad, e.place, e.curvature, e.n, e.hit);
        assert_true(e.n > 2000);
        if (level > 1) {
            assert_true(e.normal_rad < last.normal_rad / 3);
            assert_true(e.place < last.place / 2.5);
            assert_true(e.curvature < last.curvature / 1.6);
        }
        last = e;
        frame_finish(&frame);
    }
    assert_true(last.normal_rad < 1e-3 && last.normal_rad > 0);
    assert_true((double)last.same > 0.99 * (double)last.hit);
    frame_finish(&exact);
    close_scene(&scene);
}

/* The share of a wireframe's pixel that lines cover. Colours are mixed as linear light
 * (shaders/wireframe.frag.glsl). */
static double ink_of(uint8_t grey)
{
    double bare = srgb_to_linear(219 / 255.0);
    return (bare - srgb_to_linear(grey / 255.0)) / (bare - 0.01);
}

static uint8_t red_of(const struct frame *frame, size_t pixel)
{
    return ((const uint8_t *)frame->plane[0])[4 * pixel];
}

/* The wireframe of a torus of 12 x 12 quads: its planes are those of the polygons, its colours are
 * grey, and more lines make it darker, but never black. */
static void test_wireframe(void **state)
{
    (void)state;
    struct scene scene;
    build_torus(12, &scene.tables);
    open_scene(&scene, 0);
    double last = 0;
    for (uint32_t level = 0; level < 3; level++) {
        struct frame polygon = render_surface(&scene, SURFACE_POLYGON, level);
        struct frame wire = render_surface(&scene, SURFACE_WIREFRAME, level);
        size_t pixels = (size_t)wire.width_px * wire.height_px, n = 0;
        double ink = 0;
        for (int p = 1; p < PLANE_COUNT; p++)
            if (wire.plane[p])
                assert_memory_equal(wire.plane[p], polygon.plane[p],
                                    pixels * frame_plane_bytes((enum frame_plane)(1 << p)));
        for (size_t k = 0; k < pixels; k++) {
            const uint8_t *rgba = (const uint8_t *)wire.plane[0] + 4 * k;
            if (face_of(&wire, k) == UINT32_MAX) {
                assert_true(rgba[0] == 255 && rgba[1] == 0 && rgba[2] == 0);
                continue;
            }
            assert_true(rgba[0] == rgba[1] && rgba[1] == rgba[2] && rgba[3] == 255);
            assert_in_range(rgba[0], 20, 225);
            ink += ink_of(rgba[0]);
            n++;
        }
        printf("level %u: lines cover %.3f of the surface\n", level, ink / (double)n);
        assert_true(n > 5000 && ink / (double)n > 1.1 * last);
        last = ink / (double)n;
        frame_finish(&polygon);
        frame_finish(&wire);
    }
    assert_true(last < 0.36 + 0.01); /* a fifth of each direction's lines */
    close_scene(&scene);
}

/* One quad that faces the camera has lines along its edges and none along its diagonal, of the
 * promised width. */
static void test_edges_of_a_quad(void **state)
{
    (void)state;
    static const char text[] = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 8 0 0\nv 8 4 0\n"
                               "f 1 2 3 4\nf 2 5 6 3\n"
                               "t corner 4/1/0 0 3 4 5 10\n";
    struct scene scene;
    build(text, sizeof text - 1, &scene.tables);
    open_scene(&scene, 0);
    struct frame_request request = request_for(&scene);
    request.camera = (struct camera){.kind = CAMERA_ORTHOGRAPHIC,
                                     .eye = {4, 2, 5},
                                     .target = {4, 2, 0},
                                     .up = {0, 1, 0},
                                     .ortho_height = 8};
    request.surface = (struct surface){SURFACE_WIREFRAME, 0};
    struct frame frame = render(&scene, &request);
    /* 20 px a unit: the sheet covers x 40 to 200 and y 40 to 120 px; an edge lies at x = 120. */
    double across = 0;
    for (size_t x = 110; x < 130; x++)
        across += ink_of(red_of(&frame, 80 * 240 + x));
    printf("a line is %.3f px wide\n", across);
    assert_true(fabs(across - 1) < 0.02);
    for (size_t k = 50; k < 110; k++) /* the left quad's two diagonals */
        for (size_t side = 0; side < 2; side++)
            assert_int_equal(red_of(&frame, (side ? k : 159 - k) * 240 + k), 219);
    assert_true(ink_of(red_of(&frame, 80 * 240 + 40)) > 0.4);
    assert_true(ink_of(red_of(&frame, 40 * 240 + 80)) > 0.4);
    frame_finish(&frame);
    close_scene(&scene);
}

/* Where the surface has no unique normal, a polygon still has a normal to be shaded with: a sharp
 * vertex in the middle of a rough sheet, and a crease sector of six faces. */
static void test_vertices_without_a_normal(void **state)
{
    (void)state;
    enum { FACES = 6 };
    for (int tagged = 0; tagged < 2; tagged++) {
        char text[2000];
        int used = sprintf(text, "v 0 0 1\n"), n_rim = 2 * FACES + !tagged;
        for (int k = 0; k < n_rim; k++)
            used += sprintf(text + used, "v %.9f %.9f %.9f\n", cos(k * (tagged ? 0.5236 : 0.25)),
                            sin(k * (tagged ? 0.5236 : 0.25)), 0.1 * (k * k % 7));
        for (int k = 0; k < FACES; k++)
            used += sprintf(text + used, "f 1 %d %d %d\n", 2 + 2 * k, 3 + 2 * k,
                            2 + (2 * k + 2) % n_rim);
        if (tagged)
            used += sprintf(text + used, "t corner 1/1/0 0 10\n");
        struct limit_tables tables;
        struct limit_point tip;
        build(text, (size_t)used, &tables);
        assert_true(limit_evaluate(&tables, 0, 0, 0, &tip) && !tip.has_normal);
        for (uint32_t level = 0; level < 3; level++) {
            struct mesh mesh;
            struct error error;
            const struct frame_watch watch = {0};
            assert_true(mesh_init(&mesh, &tables, level, &watch, &error));
            for (size_t k = 0; k < mesh.n_vertices; k++) {
                const float *n = mesh.vertex[k].normal;
                assert_true(fabsf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-5f);
                assert_true(n[2] > 0);
            }
            mesh_finish(&mesh);
        }
        limit_tables_finish(&tables);
    }
}

/* A change of the light draws no polygon again. Another surface draws all of them, and nothing of
 * the previous surface remains. */
static void test_kept_planes(void **state)
{
    (void)state;
    static const struct surface surfaces[] = {{SURFACE_EXACT, 0},
                                              {SURFACE_POLYGON, 1},
                                              {SURFACE_WIREFRAME, 1},
                                              {SURFACE_POLYGON, 2},
                                              {SURFACE_EXACT, 0}};
    enum { N = sizeof surfaces / sizeof *surfaces };
    struct frame expected[N];
    struct scene scene;
    for (size_t k = 0; k < N; k++) { /* each drawn by a renderer that has drawn nothing before */
        build_torus(12, &scene.tables);
        open_scene(&scene, 0);
        struct frame_request request = request_for(&scene);
        request.surface = surfaces[k];
        request.lights[0].centre[0] += 0.25;
        expected[k] = render(&scene, &request);
        close_scene(&scene);
    }
    build_torus(12, &scene.tables);
    open_scene(&scene, 0);
    for (size_t k = 0; k < N; k++) {
        struct frame_request request = request_for(&scene);
        request.surface = surfaces[k];
        struct frame frame = render(&scene, &request);
        assert_true(frame.times.visibility_us > 0);
        frame_finish(&frame);
        request.lights[0].centre[0] += 0.25;
        frame = render(&scene, &request);
        assert_int_equal(frame.times.visibility_us + frame.times.evaluate_us, 0);
        assert_same(&frame, &expected[k]);
        frame_finish(&frame);
        frame_finish(&expected[k]);
    }
    close_scene(&scene);
}

/* At level 0 an n-gon is one polygon, at level 1 n quads; each Ptex face still shows its own
 * part. */
static void test_ngons(void **state)
{
    (void)state;
    struct scene scene;
    struct error error = {0};
    build_file("tests/models/ngons.obj", &scene.tables);
    open_scene(&scene, 0);
    struct mesh mesh;
    size_t n_quads = 0, n_parts = 0;
    for (size_t face = 0; face < scene.tables.n_faces; face++)
        *(scene.tables.nodes[face].ngon_size ? &n_parts : &n_quads) += 1;
    assert_true(n_parts > 0);
    for (uint32_t level = 0; level < 3; level++) {
        size_t quads = (n_quads << 2 * level) + (level ? n_parts << 2 * (level - 1) : n_parts);
        assert_true(mesh_init(&mesh, &scene.tables, level, &(struct frame_watch){0}, &error));
        assert_int_equal(mesh.n_indices, 6 * quads);
        for (size_t k = 0; k < mesh.n_vertices; k++)
            assert_true(
                ((mesh.vertex[k].face & MESH_IS_FAN) != 0) ==
                (level == 0 && scene.tables.nodes[mesh.vertex[k].face & ~MESH_IS_FAN].ngon_size));
        mesh_finish(&mesh);
    }
    struct frame_request view = request_for(&scene);
    struct frame exact = render(&scene, &view);
    double last = 0;
    for (uint32_t level = 0; level < 4; level++) {
        struct frame frame = render_surface(&scene, SURFACE_POLYGON, level);
        struct errors e = compare(&frame, &exact, view.camera.eye);
        printf("level %u: %zu of %zu pixels show their Ptex face\n", level, e.same, e.hit);
        double share = (double)e.same / (double)e.hit;
        assert_true(share > 0.5 && share > last);
        last = share;
        frame_finish(&frame);
    }
    frame_finish(&exact);
    close_scene(&scene);
}

/* 50 x 50 faces: level 6 would have 10.6 million vertices. The request is refused at once, and the
 * text names the level that fits. */
static void test_too_many(void **state)
{
    (void)state;
    struct scene scene;
    struct error error = {0};
    build_torus(50, &scene.tables);
    open_scene(&scene, 0);
    struct frame_request request = request_for(&scene);
    struct frame frame;
    request.surface = (struct surface){SURFACE_POLYGON, 6};
    assert_false(renderer_render(scene.renderer, scene.model, &request, &frame, &error));
    assert_int_equal(error.kind, ERROR_REQUEST);
    assert_non_null(strstr(error.text, "level 6 makes 10240000 polygons"));
    assert_non_null(strstr(error.text, "level 5 or less"));
    request.surface.level = 7;
    assert_false(renderer_render(scene.renderer, scene.model, &request, &frame, &error));
    assert_non_null(strstr(error.text, "level is 7; it must be"));
    request.surface.level = 2;
    frame = render(&scene, &request);
    frame_finish(&frame);
    close_scene(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_error_falls),
        cmocka_unit_test(test_wireframe),
        cmocka_unit_test(test_vertices_without_a_normal),
        cmocka_unit_test(test_edges_of_a_quad),
        cmocka_unit_test(test_kept_planes),
        cmocka_unit_test(test_ngons),
        cmocka_unit_test(test_too_many),
    };
    RETURN_FAILED_ON_BOTH_DEVICES(tests);
}
