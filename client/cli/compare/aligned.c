#include "client/cli/compare/aligned.h"

/* By the transposed rotation, which is its inverse. */
static void turn_back(const struct sheen_comparison *comparison, double v[3])
{
    const double *rotation = comparison->rotation, from[3] = {v[0], v[1], v[2]};
    for (int k = 0; k < 3; k++)
        v[k] = rotation[k] * from[0] + rotation[3 + k] * from[1] + rotation[6 + k] * from[2];
}

static void move_back(const struct sheen_comparison *comparison, double p[3])
{
    for (int k = 0; k < 3; k++)
        p[k] -= comparison->shift[k];
    turn_back(comparison, p);
}

static void move_lines(const struct sheen_comparison *comparison, struct sheen_lines *lines)
{
    if (lines->has_direction)
        turn_back(comparison, lines->direction);
    if (lines->eye_kind == SHEEN_LINE_EYE_POINT)
        move_back(comparison, lines->eye);
    else if (lines->eye_kind == SHEEN_LINE_EYE_DIRECTION)
        turn_back(comparison, lines->eye);
}

void aligned_request(const struct sheen_comparison *comparison, struct sheen_request *request)
{
    struct sheen_camera *camera = &request->camera;
    move_back(comparison, camera->eye);
    move_back(comparison, camera->target);
    turn_back(comparison, camera->up);
    move_lines(comparison, &request->lines);
    for (uint32_t i = 0; i < request->n_lights; i++) {
        move_back(comparison, request->lights[i].centre);
        turn_back(comparison, request->lights[i].u);
        turn_back(comparison, request->lights[i].v);
    }
}

static void move_plane(const struct sheen_comparison *comparison, float (*plane)[3], size_t n,
                       const double shift[3])
{
    const double *rotation = comparison->rotation;
    for (size_t i = 0; i < n; i++) {
        const double from[3] = {(double)plane[i][0], (double)plane[i][1], (double)plane[i][2]};
        for (int k = 0; k < 3; k++) {
            const double *row = rotation + 3 * k;
            plane[i][k] =
                (float)(row[0] * from[0] + row[1] * from[1] + row[2] * from[2] + shift[k]);
        }
    }
}

void aligned_frame(const struct sheen_comparison *comparison, struct sheen_frame *frame, size_t n)
{
    static const double none[3] = {0, 0, 0};
    move_plane(comparison, frame->plane[1], n, comparison->shift);
    move_plane(comparison, frame->plane[2], n, none);
}
