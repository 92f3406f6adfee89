#include "client/cli/lines/curve_view.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The sine of the angle between sight and surface below which a pixel's own plane is of no use. */
static const double GRAZING = 0.05;

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void scale_to_unit(double v[3])
{
    double length = sqrt(dot(v, v));
    for (int i = 0; i < 3 && length > 0; i++)
        v[i] /= length;
}

static void cross(const double a[3], const double b[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

void projection_init(struct projection *projection, const struct sheen_camera *camera,
                     uint32_t width_px, uint32_t height_px)
{
    *projection = (struct projection){*camera, width_px, height_px, {0}, {0}, {0}, 0};
    for (int i = 0; i < 3; i++)
        projection->forward[i] = camera->target[i] - camera->eye[i];
    scale_to_unit(projection->forward);
    cross(projection->forward, camera->up, projection->right);
    scale_to_unit(projection->right);
    cross(projection->right, projection->forward, projection->above);
    bool is_flat = camera->projection == SHEEN_PROJECTION_ORTHOGRAPHIC;
    double half = is_flat ? 0.5 * camera->ortho_height : tan(camera->fov_deg * (M_PI / 360));
    projection->scale = 0.5 * height_px / half;
}

static bool is_orthographic(const struct projection *projection)
{
    return projection->camera.projection == SHEEN_PROJECTION_ORTHOGRAPHIC;
}

double projection_place(const struct projection *projection, const double point[3], double place[2])
{
    double from[3];
    for (int i = 0; i < 3; i++)
        from[i] = point[i] - projection->camera.eye[i];
    double depth = dot(from, projection->forward);
    double scale = projection->scale / (is_orthographic(projection) ? 1 : depth);
    place[0] = 0.5 * projection->width_px + scale * dot(from, projection->right);
    place[1] = 0.5 * projection->height_px - scale * dot(from, projection->above);
    /* An orthographic camera also sees what lies behind its eye. */
    return is_orthographic(projection) ? 1 : depth;
}

void projection_tangent(const struct projection *projection, const double point[3],
                        const double along[3], double tangent[2])
{
    double place[2], depth = projection_place(projection, point, place);
    double by_depth = is_orthographic(projection) ? 0 : dot(along, projection->forward) / depth;
    double scale = projection->scale / depth;
    tangent[0] =
        scale * dot(along, projection->right) - by_depth * (place[0] - 0.5 * projection->width_px);
    tangent[1] = -scale * dot(along, projection->above) -
                 by_depth * (place[1] - 0.5 * projection->height_px);
}

static const struct sheen_curve_point *point_of(const struct sheen_curve *curve, size_t k)
{
    return &curve->points[k < curve->n_points ? k : k - curve->n_points];
}

/* A cubic between both points with their tangents. */
void curve_at(const struct sheen_curve *curve, double at, double point[3], double along[3])
{
    size_t k = (size_t)at, last = curve->n_points - (curve->is_closed ? 0 : 1);
    k = k < last ? k : last - 1;
    double t = at - (double)k, r = 1 - t, chord[3];
    const struct sheen_curve_point *a = point_of(curve, k), *b = point_of(curve, k + 1);
    for (int i = 0; i < 3; i++)
        chord[i] = b->position[i] - a->position[i];
    double length = sqrt(dot(chord, chord));
    for (int i = 0; i < 3; i++) {
        double from = a->position[i] + length / 3 * a->along[i];
        double to = b->position[i] - length / 3 * b->along[i];
        point[i] = r * r * r * a->position[i] + 3 * r * r * t * from + 3 * r * t * t * to +
                   t * t * t * b->position[i];
        along[i] = r * a->along[i] + t * b->along[i];
    }
    scale_to_unit(along);
}

/* The unit normal at a place on a curve, as curve_at() counts. */
static void normal_at(const struct sheen_curve *curve, double at, double normal[3])
{
    size_t k = (size_t)at, last = curve->n_points - (curve->is_closed ? 0 : 1);
    k = k < last ? k : last - 1;
    double t = at - (double)k;
    for (int i = 0; i < 3; i++)
        normal[i] = (1 - t) * point_of(curve, k)->normal[i] + t * point_of(curve, k + 1)->normal[i];
    scale_to_unit(normal);
}

/* How far the surface at the centre of a pixel lies behind a point along the line of sight, by the plane that touches the
 * surface there. Infinite beside the surface; NaN outside of the picture. */
static double distance_behind(const struct projection *projection, const struct view_planes *planes,
                              const double point[3], const double sight[3])
{
    double place[2], depth = projection_place(projection, point, place);
    if (!(depth > 0 && place[0] >= 0 && place[1] >= 0 && place[0] < planes->width_px &&
          place[1] < planes->height_px))
        return (double)NAN;
    size_t at = (size_t)place[1] * planes->width_px + (size_t)place[0];
    double to[3], n[3];
    for (int i = 0; i < 3; i++) {
        to[i] = (double)planes->position[at][i] - point[i];
        n[i] = (double)planes->normal[at][i];
    }
    if (!isfinite(to[0]))
        return INFINITY;
    /* At grazing sight the plane says nothing beyond the pixel. */
    double across = dot(sight, n), behind = dot(to, sight);
    return fabs(across) > GRAZING ? dot(to, n) / across : behind;
}

/* Whether the camera sees a place on a curve: the surface that the camera sees there is not before it. Where the line of
 * sight grazes the curve's own surface, as along a silhouette, a place 1.5 px beside that surface decides, whichever side of it is
 * outside. */
static bool is_visible(const struct projection *projection, const struct view_planes *planes,
                       const struct sheen_curve *curve, double at)
{
    double point[3], along[3], normal[3], place[2], sight[3];
    curve_at(curve, at, point, along);
    normal_at(curve, at, normal);
    double depth = projection_place(projection, point, place), pixel = depth / projection->scale;
    for (int i = 0; i < 3; i++)
        sight[i] = is_orthographic(projection) ? projection->forward[i]
                                               : point[i] - projection->camera.eye[i];
    scale_to_unit(sight);
    double across = fabs(dot(sight, normal)), before = 0.5 * pixel / fmax(across, GRAZING);
    bool is_grazing = across < GRAZING;
    for (int side = -1; side <= 1; side += 2) {
        double beside[3];
        for (int i = 0; i < 3; i++)
            beside[i] = point[i] + (is_grazing ? side * 1.5 * pixel * normal[i] : 0);
        if (distance_behind(projection, planes, beside, sight) > -before)
            return true;
    }
    return false;
}

struct part_list {
    struct curve_part *part;
    size_t n, room;
    bool failed;
};

static void add(struct part_list *list, uint32_t curve, bool visible, double from, double to)
{
    if (list->n == list->room) {
        size_t room = list->room ? 2 * list->room : 64;
        struct curve_part *grown = realloc(list->part, room * sizeof(*grown));
        if (!grown) {
            list->failed = true;
            return;
        }
        list->part = grown;
        list->room = room;
    }
    list->part[list->n++] = (struct curve_part){curve, visible, from, to};
}

/* The place between a and b, of which one is visible, where that changes. */
static double find_change(const struct sheen_curve *curve, const struct projection *projection,
                          const struct view_planes *planes, double a, double b)
{
    static const double ENOUGH_PX = 0.05;
    bool first = is_visible(projection, planes, curve, a);
    for (int i = 0; i < 40; i++) {
        double point[3], along[3], from[2], to[2], middle = 0.5 * (a + b);
        curve_at(curve, a, point, along);
        projection_place(projection, point, from);
        curve_at(curve, b, point, along);
        projection_place(projection, point, to);
        if (hypot(to[0] - from[0], to[1] - from[1]) < ENOUGH_PX)
            break;
        *(is_visible(projection, planes, curve, middle) == first ? &a : &b) = middle;
    }
    return 0.5 * (a + b);
}

/* How many steps lead from one point to the next, so that no step is longer than a pixel. */
static unsigned steps_between(const struct sheen_curve *curve, const struct projection *projection,
                              size_t k)
{
    double from[2], to[2];
    projection_place(projection, point_of(curve, k)->position, from);
    projection_place(projection, point_of(curve, k + 1)->position, to);
    double length = ceil(hypot(to[0] - from[0], to[1] - from[1]));
    return length > 1 ? (unsigned)fmin(length, 10000) : 1;
}

static void cut(struct part_list *list, const struct sheen_curves *curves, uint32_t index,
                const struct projection *projection, const struct view_planes *planes)
{
    const struct sheen_curve *curve = &curves->curves[index];
    size_t last = curve->n_points - (curve->is_closed ? 0 : 1);
    double start = 0, before = 0;
    bool visible = is_visible(projection, planes, curve, 0);
    for (size_t k = 0; k < last; k++) {
        unsigned n = steps_between(curve, projection, k);
        for (unsigned i = 1; i <= n; i++) {
            double at = (double)k + (double)i / n;
            bool is_now = is_visible(projection, planes, curve, at);
            if (is_now != visible) {
                double change = find_change(curve, projection, planes, before, at);
                add(list, index, visible, start, change);
                start = change;
                visible = is_now;
            }
            before = at;
        }
    }
    add(list, index, visible, start, (double)last);
}

struct curve_part *curve_parts(const struct sheen_curves *curves,
                               const struct projection *projection,
                               const struct view_planes *planes, size_t *n)
{
    struct part_list list = {.part = malloc(sizeof(*list.part)), .room = 1};
    list.failed = !list.part;
    for (uint32_t i = 0; i < curves->n_curves && !list.failed; i++)
        cut(&list, curves, i, projection, planes);
    if (list.failed) {
        free(list.part);
        return NULL;
    }
    *n = list.n;
    return list.part;
}
