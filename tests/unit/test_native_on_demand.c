/* The native device with tables on demand: the same bytes however small the cache is and whatever was
 * drawn before, and the same picture as with stored tables, whose points are rounded to single
 * precision, but for rounding; and the memory that a mesh of plain triangles takes. */
#include "server/render/native/device.h"
#include "server/render/native/native.h"
#include "server/render/native/patches.h"
#include "server/surface/evaluate.h"
#include "tests/unit/native_scene.h"

enum { WIDTH = 160, HEIGHT = 120, PX = WIDTH * HEIGHT, N_FLOATS = 9, N_WORDS = 4 };

static const char *const MODELS[] = {"tests/models/body.obj",      "tests/models/creases.obj",
                                     "tests/models/ngons.obj",     "tests/models/pole.obj",
                                     "tests/models/triangles.obj", "tests/models/tetra.obj"};
enum { N_MODELS = sizeof MODELS / sizeof *MODELS };

/* --- stages 1 and 2 */

struct planes {
    float floats[N_FLOATS][PX];
    uint32_t words[N_WORDS][PX];
};

static void draw(unsigned n_threads, struct native_model *model, const struct camera *camera,
                 struct planes *planes)
{
    struct error error = {0};
    const struct native_options options = {.n_threads = n_threads};
    struct native_device *device = native_device_create(&options, &error);
    assert_non_null(device);
    float(*f)[PX] = planes->floats;
    uint32_t(*w)[PX] = planes->words;
    memset(planes, 0, sizeof *planes);
    const struct native_planes at = {.pitch = WIDTH,
                                     .depth = f[0],
                                     .normal = {f[1], f[2], f[3]},
                                     .shape = {f[4], f[5], f[6]},
                                     .u = f[7],
                                     .v = f[8],
                                     .face = w[0],
                                     .border = w[1],
                                     .node = w[2],
                                     .where = w[3]};
    const struct tile whole = {0, 0, WIDTH, HEIGHT};
    struct view view;
    view_init(&view, camera, WIDTH, HEIGHT, model->tables->hull_min, model->tables->hull_max);
    if (!native_draw(device, model, &view, &whole, &at, NULL, &error))
        fail_msg("%s", error.text);
    native_device_destroy(device);
}

static struct native_model *open_model(const struct limit_tables *tables, size_t bytes)
{
    struct error error = {0};
    struct native_model *model = native_model_create(tables, bytes, &error);
    if (!model)
        fail_msg("%s", error.text);
    return model;
}

static size_t assert_same_planes(const struct planes *a, const struct planes *b, const char *name)
{
    size_t n = 0;
    for (size_t i = 0; i < PX; i++) {
        bool is_hit = a->floats[0][i] > 0;
        n += is_hit;
        for (int k = 0; k < N_FLOATS && (is_hit || k == 0); k++)
            if (memcmp(&a->floats[k][i], &b->floats[k][i], sizeof(float)) != 0)
                fail_msg("%s: plane %d of pixel %zu differs", name, k, i);
        for (int k = 0; k < N_WORDS && is_hit; k++)
            assert_int_equal(a->words[k][i], b->words[k][i]);
    }
    return n;
}

/* A camera so near to the vertex of an inner corner that a pixel is 2^-24 of the node. */
static bool zoom_on_corner(const struct limit_tables *tables, struct camera *camera)
{
    uint32_t i = 0;
    while (i < tables->n_nodes &&
           (tables->nodes[i].kind != LIMIT_CORNER || tables->nodes[i].levels & LIMIT_NO_NORMAL))
        i++;
    if (i == tables->n_nodes)
        return false;
    double size = (double)tables->whole[i].radius;
    const struct limit_place place = {i, tables->nodes[i].rotation, 0, 0};
    struct limit_point vertex;
    assert_true(limit_evaluate_at(tables, &place, &vertex));
    struct vec aside = fabs(vertex.n.x) < 0.7 ? (struct vec){1, 0, 0} : (struct vec){0, 1, 0};
    struct vec eye = vec_mad(vertex.s, 0.1 * size, vec_mad(vertex.n, 0.1, aside));
    *camera = (struct camera){.kind = CAMERA_ORTHOGRAPHIC,
                              .ortho_height = ldexp(size, -24) * HEIGHT,
                              .eye = {eye.x, eye.y, eye.z},
                              .target = {vertex.s.x, vertex.s.y, vertex.s.z},
                              .up = {aside.x, aside.y, aside.z}};
    return true;
}

static void test_same_planes(void **state)
{
    (void)state;
    static struct planes from_all, from_made;
    for (size_t m = 0; m < N_MODELS; m++) {
        struct limit_tables made;
        struct camera camera[2];
        build_file_on_demand(MODELS[m], &made);
        scene_default_camera(&made, NULL, VIEW_AROUND, WIDTH, HEIGHT, &camera[0]);
        assert_true(zoom_on_corner(&made, &camera[1]));
        /* Models that keep all patches, almost none, and a megabyte of them, against one that is new for each view. */
        const size_t bytes[3] = {NATIVE_PATCH_BYTES, 0, 1 << 20};
        struct native_model *model[3];
        for (int k = 0; k < 3; k++)
            model[k] = open_model(&made, bytes[k]);
        for (int look = 0; look < 4; look++) {
            struct native_model *all = open_model(&made, NATIVE_PATCH_BYTES);
            draw(1, all, &camera[look & 1], &from_all);
            native_model_destroy(all);
            for (int k = 0; k < 3; k++) {
                draw(1 + (unsigned)(look + k) % 3, model[k], &camera[look & 1], &from_made);
                size_t n = assert_same_planes(&from_all, &from_made, MODELS[m]);
                if (n <= PX / 20)
                    fail_msg("%s: %zu pixels from view %d", MODELS[m], n, look);
            }
        }
        assert_true(native_model_bytes(model[1]) < 400000);
        for (int k = 0; k < 3; k++)
            native_model_destroy(model[k]);
        limit_tables_finish(&made);
    }
}

/* --- whole pictures, with outlines and roundings */

static void test_alike_with_stored_tables(void **state)
{
    (void)state;
    const struct renderer_options options = {.device = "native"};
    struct error error = {0};
    struct renderer *renderer = renderer_create(&native_renderer_device, &options, &error);
    assert_non_null(renderer);
    for (size_t m = 0; m < N_MODELS; m++) {
        struct limit_tables tables[2];
        struct frame frame[2];
        build_file(MODELS[m], &tables[0]);
        build_file_on_demand(MODELS[m], &tables[1]);
        for (int k = 0; k < 2; k++) {
            struct renderer_model *model = upload(renderer, &tables[k]);
            struct frame_request request = request_for(&tables[k], WIDTH, HEIGHT);
            frame[k] = render(renderer, model, &request);
            renderer_model_destroy(renderer, model);
        }
        const struct difference found = compare(&frame[0], &frame[1]);
        assert_alike(&found, MODELS[m]);
        assert_true(hits(&frame[0]) > PX / 20);
        for (int k = 0; k < 2; k++) {
            frame_finish(&frame[k]);
            limit_tables_finish(&tables[k]);
        }
    }
    renderer_destroy(renderer);
}

/* --- memory */

/* 2 n x n triangles: inner vertices have six of them; each face has extraordinary vertices of
 * valence 3 once it is divided into quads. */
static void build_triangles(unsigned n, struct limit_tables *tables)
{
    size_t room = 100 * (size_t)(n + 1) * (n + 1) + 1000, used = 0;
    char *text = malloc(room);
    assert_non_null(text);
    for (unsigned k = 0; k < (n + 1) * (n + 1); k++)
        used +=
            (size_t)snprintf(text + used, room - used, "v %u %u %.5f\n", k % (n + 1), k / (n + 1),
                             8 * sin(k % (n + 1) / 16.0) * cos(k / (n + 1) / 20.0));
    for (unsigned k = 0; k < n * n; k++) {
        unsigned a = k / n * (n + 1) + k % n + 1;
        used += (size_t)snprintf(text + used, room - used, "f %u %u %u\nf %u %u %u\n", a, a + 1,
                                 a + n + 2, a, a + n + 2, a + n + 1);
    }
    build_as("scene.obj", text, used, false, tables);
    free(text);
}

static size_t bytes_of(const struct limit_tables *tables)
{
    return limit_tables_host_bytes(tables) + native_model_most_bytes(tables, NATIVE_PATCH_BYTES);
}

/* 10,000 triangles, all visible: stored tables would take 50,000 levels of 10,000 bytes each. */
static void test_triangles(void **state)
{
    (void)state;
    enum { N = 71, TRIANGLES = 2 * N * N };
    static struct planes planes;
    struct limit_tables tables;
    struct camera camera;
    build_triangles(N, &tables);
    assert_int_equal(tables.n_faces, 3 * TRIANGLES);
    assert_int_equal(tables.count[LIMIT_CORNER],
                     6 * TRIANGLES - 4); /* two vertices have two triangles each and are regular */
    scene_default_camera(&tables, NULL, VIEW_TOP, WIDTH, HEIGHT, &camera);
    struct native_model *model = open_model(&tables, NATIVE_PATCH_BYTES);
    draw(2, model, &camera, &planes);
    size_t n = 0;
    for (size_t i = 0; i < PX; i++)
        n += planes.floats[0][i] > 0;
    assert_true(n > PX / 3);
    assert_true(native_model_bytes(model) <= native_model_most_bytes(&tables, NATIVE_PATCH_BYTES));
    /* The cache of patches and bounds is limited. The rest is 15 nodes for each triangle, of 48, 64
     * and 24 bytes, and the cage. */
    struct limit_tables fewer;
    enum { M = 67, FEWER = 2 * M * M };
    build_triangles(M, &fewer);
    size_t more = bytes_of(&tables) - bytes_of(&fewer);
    assert_true(more > (TRIANGLES - FEWER) * (size_t)(15 * (48 + 64 + 24)));
    assert_true(more < (TRIANGLES - FEWER) * (size_t)2700);
    limit_tables_finish(&fewer);
    native_model_destroy(model);
    limit_tables_finish(&tables);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_planes),
        cmocka_unit_test(test_alike_with_stored_tables),
        cmocka_unit_test(test_triangles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
