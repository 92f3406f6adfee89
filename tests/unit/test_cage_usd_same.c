/* Random cages with all tags, written as USD and as OBJ: both readers give the same cage, bit for bit. Positions that
 * transforms move are compared with products of 4x4 matrices in long double. SHEEN_FUZZ_SEED chooses the cages. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/unit/usd_sample.h"

#define N_CAGES 400
#define MAX_POINTS 30
#define MAX_FACES 20
#define MAX_CORNERS 8
#define MAX_MESHES 3
#define TEXT_BYTES (1 << 17)

/* --- random numbers and texts that grow */

static uint64_t random_state;

static unsigned pick(unsigned n)
{
    random_state = random_state * 6364136223846793005u + 1442695040888963407u;
    return (unsigned)((random_state >> 33) % n);
}

static double between(double low, double high)
{
    return low + (high - low) * (pick(1u << 30) / (double)(1u << 30));
}

struct text {
    char bytes[TEXT_BYTES];
    size_t size;
};

__attribute__((format(printf, 2, 3))) static void add(struct text *text, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    text->size +=
        (size_t)vsnprintf(text->bytes + text->size, TEXT_BYTES - text->size, format, args);
    va_end(args);
    assert_true(text->size < TEXT_BYTES);
}

/* What separates tokens of USD. */
static const char *blank(void)
{
    static const char *const blanks[] = {" ", "\n", "\t", " # ]\n", "/* [ */", "\r\n", "//(\n "};
    return blanks[pick(3) ? 0 : pick(sizeof blanks / sizeof *blanks)];
}

/* --- a random mesh */

struct mesh {
    unsigned n_points, n_faces;
    char point[MAX_POINTS][3][32]; /* as text */
    unsigned n_corners[MAX_FACES];
    int corner[MAX_FACES][MAX_CORNERS];
    unsigned n_creases, crease_length[4];
    int crease[4][4];
    bool each_edge;
    char sharpness[4][3][32]; /* of each edge, or the first for the whole crease */
    unsigned n_tags;
    int tagged[4];
    char tag_sharpness[4][32];
    unsigned n_holes;
    int hole[3];
    bool left_handed, smooth;
    int boundary; /* 0 none, 1 edgeAndCorner, 2 edgeOnly, as OBJ counts them; as text in USD */
};

static void make_number(char text[32])
{
    static const char *const odd[] = {"0",   "-0", "1e-30", "0.1", "-2.5e10", "123456789.123456789",
                                      "1e22"};
    if (pick(20) == 0)
        snprintf(text, 32, "%s", odd[pick(7)]);
    else
        snprintf(text, 32, pick(2) ? "%.17g" : "%.6g", between(-3, 3));
}

static void make_sharpness(char text[32])
{
    static const char *const odd[] = {"0", "10", "1e3", "-1", "0.5"};
    if (pick(2))
        snprintf(text, 32, "%s", odd[pick(5)]);
    else
        snprintf(text, 32, "%.9g", between(0, 10));
}

/* Corners of one face: mostly different, sometimes damaged. */
static void make_face(struct mesh *mesh, unsigned f)
{
    unsigned n = pick(20) ? 3 + pick(3) : pick(MAX_CORNERS);
    mesh->n_corners[f] = n;
    for (unsigned c = 0; c < n; c++)
        mesh->corner[f][c] = pick(30) ? (int)((pick(mesh->n_points) + c * 7) % mesh->n_points) : 0;
}

/* A crease along a face, or between any vertices, also some that do not exist. */
static void make_crease(struct mesh *mesh, unsigned k)
{
    unsigned f = pick(mesh->n_faces), n = mesh->n_corners[f];
    mesh->crease_length[k] = 2 + pick(3);
    for (unsigned i = 0; i < mesh->crease_length[k]; i++) {
        mesh->crease[k][i] = n > 0 ? mesh->corner[f][i % n] : 0;
        if (pick(10) == 0)
            mesh->crease[k][i] = pick(2) ? (int)mesh->n_points + 3 : -1;
    }
    for (unsigned i = 0; i < 3; i++)
        make_sharpness(mesh->sharpness[k][i]);
}

static void make_mesh(struct mesh *mesh)
{
    *mesh = (struct mesh){.n_points = 4 + pick(MAX_POINTS - 4), .n_faces = 1 + pick(MAX_FACES)};
    for (unsigned v = 0; v < mesh->n_points; v++)
        for (int i = 0; i < 3; i++)
            make_number(mesh->point[v][i]);
    for (unsigned f = 0; f < mesh->n_faces; f++)
        make_face(mesh, f);
    mesh->each_edge = pick(2);
    for (mesh->n_creases = 0; mesh->n_creases < 4 && pick(3); mesh->n_creases++)
        make_crease(mesh, mesh->n_creases);
    for (; mesh->n_tags < 4 && pick(2); mesh->n_tags++) {
        mesh->tagged[mesh->n_tags] = pick(9) ? (int)pick(mesh->n_points) : -1;
        make_sharpness(mesh->tag_sharpness[mesh->n_tags]);
    }
    for (; mesh->n_holes < 3 && pick(3) == 0; mesh->n_holes++)
        mesh->hole[mesh->n_holes] = pick(9) ? (int)pick(mesh->n_faces) : (int)mesh->n_faces;
    mesh->left_handed = pick(3) == 0;
}

/* --- as USD */

static void usd_list(struct text *out, const char *type, const char *name)
{
    add(out, "%s[]%s%s%s=%s[", type, blank(), name, blank(), blank());
}

static void usd_faces(struct text *out, const struct mesh *mesh)
{
    usd_list(out, "int", "faceVertexCounts");
    for (unsigned f = 0; f < mesh->n_faces; f++)
        add(out, "%s%u%s", f ? "," : "", mesh->n_corners[f], blank());
    add(out, "]%s", blank());
    usd_list(out, "int", "faceVertexIndices");
    bool first = true;
    for (unsigned f = 0; f < mesh->n_faces; f++) {
        for (unsigned c = 0; c < mesh->n_corners[f]; c++) {
            /* The first corner stays first. */
            unsigned at = mesh->left_handed && c > 0 ? mesh->n_corners[f] - c : c;
            add(out, "%s%s%d", first ? "" : ",", blank(), mesh->corner[f][at]);
            first = false;
        }
    }
    add(out, "]%s", blank());
    if (mesh->left_handed || pick(2))
        add(out, "uniform token orientation = \"%s\"\n",
            mesh->left_handed ? "leftHanded" : "rightHanded");
}

static void usd_creases(struct text *out, const struct mesh *mesh)
{
    if (mesh->n_creases == 0)
        return;
    usd_list(out, "float", "creaseSharpnesses");
    for (unsigned k = 0; k < mesh->n_creases; k++)
        for (unsigned i = 0; i < (mesh->each_edge ? mesh->crease_length[k] - 1 : 1); i++)
            add(out, "%s%s", k || i ? ", " : "", mesh->sharpness[k][i]);
    add(out, "]%s", blank());
    usd_list(out, "int", "creaseIndices");
    for (unsigned k = 0; k < mesh->n_creases; k++)
        for (unsigned i = 0; i < mesh->crease_length[k]; i++)
            add(out, "%s%d", k || i ? ", " : "", mesh->crease[k][i]);
    add(out, "]%s", blank());
    usd_list(out, "int", "creaseLengths");
    for (unsigned k = 0; k < mesh->n_creases; k++)
        add(out, "%s%u", k ? ", " : "", mesh->crease_length[k]);
    add(out, "]%s", blank());
}

static void usd_corners_and_holes(struct text *out, const struct mesh *mesh)
{
    usd_list(out, "int", "cornerIndices");
    for (unsigned k = 0; k < mesh->n_tags; k++)
        add(out, "%s%d", k ? ", " : "", mesh->tagged[k]);
    add(out, "]%s", blank());
    usd_list(out, "float", "cornerSharpnesses");
    for (unsigned k = 0; k < mesh->n_tags; k++)
        add(out, "%s%s", k ? ", " : "", mesh->tag_sharpness[k]);
    add(out, "]%s", blank());
    usd_list(out, "int", "holeIndices");
    for (unsigned k = 0; k < mesh->n_holes; k++)
        add(out, "%s%d", k ? ", " : "", mesh->hole[k]);
    add(out, "]%s", blank());
}

static void usd_mesh(struct text *out, const struct mesh *mesh)
{
    static const char *const boundaries[] = {"none", "edgeAndCorner", "edgeOnly"};
    add(out, "def%sMesh%s\"m\"%s{%s", blank(), blank(), blank(), blank());
    if (mesh->boundary != 1 || pick(2)) /* edgeAndCorner is USD's own default */
        add(out, "uniform token interpolateBoundary = \"%s\"\n", boundaries[mesh->boundary]);
    if (mesh->smooth)
        add(out, "uniform token triangleSubdivisionRule = \"smooth\"%s", blank());
    usd_corners_and_holes(out, mesh);
    usd_list(out, "point3f", "points");
    for (unsigned v = 0; v < mesh->n_points; v++)
        add(out, "%s(%s,%s%s,%s)", v ? "," : "", mesh->point[v][0], blank(), mesh->point[v][1],
            mesh->point[v][2]);
    add(out, "]%s", blank());
    usd_faces(out, mesh);
    usd_creases(out, mesh);
    add(out, "}%s", blank());
}

/* --- as OBJ */

#define NOWHERE 999999999 /* an index of no element of the file */

static int obj_index(int index, unsigned n, unsigned base)
{
    return index >= 0 && index < (int)n ? index + (int)base : NOWHERE;
}

static void obj_tags(struct text *out, const struct mesh *mesh, unsigned base, unsigned first_face)
{
    for (unsigned k = 0; k < mesh->n_creases; k++)
        for (unsigned i = 0; i + 1 < mesh->crease_length[k]; i++)
            add(out, "t crease 2/1/0 %d %d %s\n",
                obj_index(mesh->crease[k][i], mesh->n_points, base),
                obj_index(mesh->crease[k][i + 1], mesh->n_points, base),
                mesh->sharpness[k][mesh->each_edge ? i : 0]);
    for (unsigned k = 0; k < mesh->n_tags; k++)
        add(out, "t corner 1/1/0 %d %s\n", obj_index(mesh->tagged[k], mesh->n_points, base),
            mesh->tag_sharpness[k]);
    for (unsigned k = 0; k < mesh->n_holes; k++)
        add(out, "t hole 1/0/0 %d\n", obj_index(mesh->hole[k], mesh->n_faces, first_face));
}

/* The vertices of one face, which edgeAndCorner makes sharp. */
static void obj_sharp_corners(struct text *out, const struct mesh *mesh, unsigned base)
{
    for (unsigned v = 0; v < mesh->n_points; v++) {
        unsigned n = 0;
        for (unsigned f = 0; f < mesh->n_faces; f++) {
            bool has = false;
            for (unsigned c = 0; c < mesh->n_corners[f]; c++)
                has |= mesh->corner[f][c] == (int)v;
            n += has;
        }
        if (n == 1)
            add(out, "t corner 1/1/0 %u 10\n", v + base);
    }
}

static void obj_mesh(struct text *out, const struct mesh *mesh, unsigned base, unsigned first_face)
{
    for (unsigned v = 0; v < mesh->n_points; v++)
        add(out, "v %s %s %s\n", mesh->point[v][0], mesh->point[v][1], mesh->point[v][2]);
    for (unsigned f = 0; f < mesh->n_faces; f++) {
        add(out, "f");
        for (unsigned c = 0; c < mesh->n_corners[f]; c++)
            add(out, " %u", (unsigned)mesh->corner[f][c] + base + 1);
        add(out, "\n");
    }
    obj_tags(out, mesh, base, first_face);
}

/* --- the comparison */

static void expect_equal(const struct cage *usd, const struct cage *obj)
{
    assert_true(usd->n_vertices == obj->n_vertices && usd->n_faces == obj->n_faces);
    assert_memory_equal(usd->position, obj->position, usd->n_vertices * sizeof *usd->position);
    assert_memory_equal(usd->face_start, obj->face_start,
                        (usd->n_faces + 1) * sizeof *usd->face_start);
    assert_memory_equal(usd->face_vertex, obj->face_vertex,
                        usd->face_start[usd->n_faces] * sizeof *usd->face_vertex);
    assert_true(usd->scheme == obj->scheme && usd->boundary == obj->boundary);
    assert_true(usd->smooth_triangles == obj->smooth_triangles && usd->chaikin == obj->chaikin);
    assert_true(usd->n_creases == obj->n_creases && usd->n_corners == obj->n_corners);
    assert_true(usd->n_holes == obj->n_holes && usd->n_findings == obj->n_findings);
    if (usd->n_creases)
        assert_memory_equal(usd->crease, obj->crease, usd->n_creases * sizeof *usd->crease);
    if (usd->n_corners)
        assert_memory_equal(usd->corner, obj->corner, usd->n_corners * sizeof *usd->corner);
    if (usd->n_holes)
        assert_memory_equal(usd->hole, obj->hole, usd->n_holes * sizeof *usd->hole);
    for (size_t i = 0; i < usd->n_findings; i++)
        assert_true(usd->finding[i].kind == obj->finding[i].kind &&
                    usd->finding[i].count == obj->finding[i].count);
}

static struct text usd_text, obj_text;

/* Writes random meshes in both forms. */
static void write_both(unsigned n)
{
    static struct mesh mesh[MAX_MESHES];
    usd_text.size = obj_text.size = 0;
    add(&usd_text, "#usda 1.0\n");
    bool smooth = pick(4) == 0, none = pick(6) == 0, mixed = false;
    for (unsigned m = 0; m < n; m++) {
        make_mesh(&mesh[m]);
        mesh[m].smooth = smooth;
        mesh[m].boundary = none ? 0 : 1 + (int)pick(2);
        mixed |= mesh[m].boundary != mesh[0].boundary;
        usd_mesh(&usd_text, &mesh[m]);
    }
    unsigned base = 0, first_face = 0;
    for (unsigned m = 0; m < n; m++) {
        obj_mesh(&obj_text, &mesh[m], base, first_face);
        if (mixed && mesh[m].boundary == 1)
            obj_sharp_corners(&obj_text, &mesh[m], base);
        base += mesh[m].n_points;
        first_face += mesh[m].n_faces;
    }
    add(&obj_text, "t interpolateboundary 1/0/0 %d\n", mixed ? 2 : mesh[0].boundary);
    if (smooth)
        add(&obj_text, "t smoothtriangles 0/0/1 smooth\n");
}

static void test_same(void **state)
{
    const char *seed = getenv("SHEEN_FUZZ_SEED");
    (void)state;
    unsigned n_read = 0;
    for (unsigned k = 0; k < N_CAGES; k++) {
        struct cage usd, obj;
        struct error usd_error = {0}, obj_error = {0};
        random_state = (seed ? strtoull(seed, NULL, 10) : 7) * 1000003 + k;
        write_both(1 + pick(MAX_MESHES));
        bool is_obj = cage_read(&obj, obj_text.bytes, obj_text.size, "a.obj", &obj_error);
        bool is_usd = cage_read(&usd, usd_text.bytes, usd_text.size, "a.usda", &usd_error);
        if (is_obj != is_usd)
            fail_msg("cage %u: OBJ: %s, USD: %s\n%s", k, obj_error.text, usd_error.text,
                     usd_text.bytes);
        if (!is_obj)
            continue;
        n_read++;
        expect_equal(&usd, &obj);
        cage_finish(&usd);
        cage_finish(&obj);
    }
    assert_true(n_read > N_CAGES * 9 / 10);
}

/* Reads a file of the repository. */
static void read_model(struct cage *cage, const char *path)
{
    static char bytes[1 << 16];
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    read_bytes(cage, bytes, size, path);
}

static void test_model(void **state)
{
    (void)state;
    struct cage usd, obj;
    read_model(&usd, "tests/models/creases.usda");
    read_model(&obj, "tests/models/creases.obj");
    assert_true(usd.n_creases > 0 && usd.n_corners > 0 && usd.n_holes > 0);
    expect_equal(&usd, &obj);
    cage_finish(&usd);
    cage_finish(&obj);
}

/* --- transforms */

typedef long double matrix[4][4]; /* for points as columns */

static void multiply(matrix a, matrix b, matrix product)
{
    matrix sum = {{0}};
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            for (int k = 0; k < 4; k++)
                sum[i][j] += a[i][k] * b[k][j];
    memcpy(product, sum, sizeof sum);
}

static void identity(matrix m)
{
    memset(m, 0, sizeof(matrix));
    for (int i = 0; i < 4; i++)
        m[i][i] = 1;
}

static void turn_about(matrix m, int axis, long double degrees)
{
    const long double angle = degrees * 3.14159265358979323846264338327950288L / 180;
    int a = (axis + 1) % 3, b = (axis + 2) % 3;
    identity(m);
    m[a][a] = m[b][b] = cosl(angle);
    m[b][a] = sinl(angle);
    m[a][b] = -m[b][a];
}

/* The inverse by Gauss's elimination with the largest pivot. */
static void inverse_of(matrix m, matrix inverse)
{
    matrix left;
    memcpy(left, m, sizeof left);
    identity(inverse);
    for (int k = 0; k < 4; k++) {
        int best = k;
        for (int i = k; i < 4; i++)
            if (fabsl(left[i][k]) > fabsl(left[best][k]))
                best = i;
        for (int j = 0; j < 4; j++) {
            long double a = left[k][j], b = inverse[k][j];
            left[k][j] = left[best][j], inverse[k][j] = inverse[best][j];
            left[best][j] = a, inverse[best][j] = b;
        }
        const long double pivot = left[k][k];
        for (int j = 0; j < 4; j++)
            left[k][j] /= pivot, inverse[k][j] /= pivot;
        for (int i = 0; i < 4; i++) {
            const long double factor = i == k ? 0 : left[i][k];
            for (int j = 0; j < 4; j++)
                left[i][j] -= factor * left[k][j], inverse[i][j] -= factor * inverse[k][j];
        }
    }
}

/* Writes one random op with the suffix `s` and gives its matrix. */
static void make_op(struct text *out, char *name, unsigned s, matrix m)
{
    static const char *const orders[] = {"XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"};
    double v[4] = {between(-3, 3), between(-3, 3), between(-3, 3), between(0.5, 3)};
    int axis = (int)pick(3);
    identity(m);
    switch (pick(8)) {
    case 0:
        sprintf(name, "xformOp:translate:s%u", s);
        add(out, "double3 %s = (%.17g, %.17g, %.17g)\n", name, v[0], v[1], v[2]);
        for (int i = 0; i < 3; i++)
            m[i][3] = v[i];
        break;
    case 1:
        sprintf(name, "xformOp:scale:s%u", s);
        add(out, "double3 %s = (%.17g, %.17g, %.17g)\n", name, v[3], -v[3], 1.5);
        m[0][0] = v[3], m[1][1] = -v[3], m[2][2] = 1.5;
        break;
    case 2:
        v[0] *= 100;
        sprintf(name, "xformOp:rotate%c:s%u", 'X' + axis, s);
        add(out, "double %s = %.17g\n", name, v[0]);
        turn_about(m, axis, v[0]);
        break;
    case 3: {
        const char *order = orders[pick(6)];
        sprintf(name, "xformOp:rotate%s:s%u", order, s);
        add(out, "double3 %s = (%.17g, %.17g, %.17g)\n", name, 60 * v[0], 60 * v[1], 60 * v[2]);
        for (int i = 0; i < 3; i++) {
            matrix one;
            turn_about(one, order[i] - 'X', 60 * v[order[i] - 'X']);
            multiply(one, m, m);
        }
        break;
    }
    case 4: {
        /* Columns are what the quaternion q e q* makes of the axes. */
        const long double w = v[0], x = v[1], y = v[2], z = v[3], n = w * w + x * x + y * y + z * z;
        const long double r[3][3] = {
            {w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)},
            {2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)},
            {2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z}};
        sprintf(name, "xformOp:orient:s%u", s);
        add(out, "quatd %s = (%.17g, %.17g, %.17g, %.17g)\n", name, v[0], v[1], v[2], v[3]);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                m[i][j] = r[i][j] / n;
        break;
    }
    case 5:
        sprintf(name, "xformOp:translate%c:s%u", 'X' + axis, s);
        add(out, "double %s = %.17g\n", name, v[0]);
        m[axis][3] = v[0];
        break;
    case 6:
        sprintf(name, "xformOp:scale%c:s%u", 'X' + axis, s);
        add(out, "double %s = %.17g\n", name, v[3]);
        m[axis][axis] = v[3];
        break;
    default:
        sprintf(name, "xformOp:transform:s%u", s);
        add(out, "matrix4d %s = (", name);
        for (int row = 0; row < 4; row++) {
            for (int i = 0; i < 3; i++) /* a row of the text is a column for points as columns */
                m[i][row] = row == (int)i ? 2 + between(0, 1) : between(-0.5, 0.5);
            add(out, "%s(%.17g, %.17g, %.17g, %d)", row ? ", " : "", (double)m[0][row],
                (double)m[1][row], (double)m[2][row], row == 3);
        }
        add(out, ")\n");
    }
}

/* Opens a prim with random ops and multiplies its transform to that of its parents. */
static void open_placed(struct text *out, const char *type, matrix world)
{
    char order[1000] = "", name[40];
    add(out, "def %s \"p\" {\n", type);
    for (unsigned s = 0, n = pick(4); s < n; s++) {
        matrix m, inverse;
        make_op(out, name, s, m);
        bool inverted = pick(3) == 0;
        if (inverted) {
            inverse_of(m, inverse);
            memcpy(m, inverse, sizeof m);
        }
        multiply(world, m, world);
        sprintf(order + strlen(order), "%s\"%s%s\"", s ? ", " : "", inverted ? "!invert!" : "",
                name);
    }
    add(out, "uniform token[] xformOpOrder = [%s]\n", order);
}

/* A transform that mirrors turns the face, which keeps its first corner. */
static void expect_winding(const struct cage *cage, matrix w)
{
    long double determinant = 0;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        determinant += w[0][i] * (w[1][j] * w[2][k] - w[1][k] * w[2][j]);
    }
    if (determinant < 0)
        EXPECT_FACE(cage, 0, 0, 3, 2, 1);
    else
        EXPECT_FACE(cage, 0, 0, 1, 2, 3);
}

static void test_transforms(void **state)
{
    (void)state;
    for (unsigned k = 0; k < N_CAGES; k++) {
        matrix world;
        struct cage cage;
        long double largest = 0, sum = 0;
        random_state = 77000003 + k;
        identity(world);
        usd_text.size = 0;
        add(&usd_text, "#usda 1.0\n");
        unsigned depth = pick(4);
        for (unsigned d = 0; d < depth; d++)
            open_placed(&usd_text, "Xform", world);
        open_placed(&usd_text, "Mesh", world);
        double point[4][3];
        add(&usd_text, "int[] faceVertexCounts = [4]\nint[] faceVertexIndices = "
                       "[0,1,2,3]\npoint3f[] points = [");
        for (int v = 0; v < 4; v++) {
            for (int i = 0; i < 3; i++)
                point[v][i] = between(-1, 1);
            add(&usd_text, "%s(%.17g, %.17g, %.17g)", v ? ", " : "", point[v][0], point[v][1],
                point[v][2]);
        }
        add(&usd_text, "]\n}\n");
        for (unsigned d = 0; d < depth; d++)
            add(&usd_text, "}\n");
        read_bytes(&cage, usd_text.bytes, usd_text.size, "a.usda");
        for (int i = 0; i < 4; i++)
            for (int j = 0; j < 4; j++)
                sum += fabsl(world[i][j]);
        for (int v = 0; v < 4; v++)
            for (int i = 0; i < 3; i++) {
                long double expected = world[i][3];
                for (int j = 0; j < 3; j++)
                    expected += world[i][j] * point[v][j];
                largest = fmaxl(largest, fabsl(expected - cage.position[v][i]));
            }
        expect_winding(&cage, world);
        /* Products of up to 16 matrices, of which some cancel. */
        if (largest > 2e-13L * sum)
            fail_msg("transform %u: off by %Lg of %Lg\n%s", k, largest, sum, usd_text.bytes);
        cage_finish(&cage);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same),
        cmocka_unit_test(test_model),
        cmocka_unit_test(test_transforms),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
