#include "server/cage/build/bodies.h"

#include <stdlib.h>

/* A body whose volume is below this share of the sum of its parts' magnitudes may be flat. */
#define LEAST_VOLUME 1e-6
/* The number of bodies, the largest ones, that may have hollows. */
#define MOST_OUTER 16

struct body {
    uint32_t first;       /* its first face */
    bool is_open;         /* the body is not closed, or to be left out */
    double volume, parts; /* six times the signed volume, and the sum of its parts' magnitudes */
    double low[3], high[3];
};

static void cross(double out[3], const double a[3], const double b[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* A corner's position relative to `origin`, so that the volume of a body far from the world's
 * origin is precise. Volumes are finite for coordinates up to CAGE_MAX_COORDINATE. */
static void place(const struct cage *cage, uint32_t corner, const double origin[3], double out[3])
{
    const double *position = cage->position[cage->face_vertex[corner]];
    for (int i = 0; i < 3; i++)
        out[i] = position[i] - origin[i];
}

/* Adds a face's part of the volume; the face is a fan of triangles from its first corner. */
static void add_volume(struct body *body, const struct cage *cage, uint32_t face,
                       const double origin[3])
{
    double p[3], q[3], r[3], normal[3];
    uint32_t first = cage->face_start[face], last = cage->face_start[face + 1];
    place(cage, first, origin, p);
    for (uint32_t c = first + 1; c + 1 < last; c++) {
        place(cage, c, origin, q);
        place(cage, c + 1, origin, r);
        cross(normal, q, r);
        double part = p[0] * normal[0] + p[1] * normal[1] + p[2] * normal[2];
        body->volume += part;
        body->parts += part < 0 ? -part : part;
    }
}

static void add_box(struct body *body, const struct cage *cage, uint32_t face)
{
    for (uint32_t c = cage->face_start[face]; c < cage->face_start[face + 1]; c++) {
        const double *position = cage->position[cage->face_vertex[c]];
        for (int i = 0; i < 3; i++) {
            body->low[i] = position[i] < body->low[i] ? position[i] : body->low[i];
            body->high[i] = position[i] > body->high[i] ? position[i] : body->high[i];
        }
    }
}

/* The position of the body's first corner: the origin of its volume, and where its box begins. */
static const double *origin_of(const struct cage *cage, const struct body *body)
{
    return cage->position[cage->face_vertex[cage->face_start[body->first]]];
}

static void begin_body(struct body *body, const struct cage *cage, uint32_t face)
{
    body->first = face;
    for (int i = 0; i < 3; i++)
        body->low[i] = body->high[i] = origin_of(cage, body)[i];
}

/* Numbers the bodies in number_of[], indexed by one face of each, in the order of their first
 * faces. Returns their number. */
static uint32_t number_bodies(const struct bodies *bodies, uint32_t *number_of)
{
    uint32_t n = 0;
    for (uint32_t f = 0; f < bodies->cage->n_faces; f++)
        number_of[f] = UINT32_MAX;
    for (uint32_t f = 0; f < bodies->cage->n_faces; f++)
        if (number_of[bodies->body[f]] == UINT32_MAX)
            number_of[bodies->body[f]] = n++;
    return n;
}

static void measure(const struct bodies *bodies, const uint32_t *number_of, struct body *body)
{
    const struct cage *cage = bodies->cage;
    uint32_t n = 0;
    for (uint32_t f = 0; f < cage->n_faces; f++) {
        uint32_t number = number_of[bodies->body[f]];
        if (number == n)
            begin_body(&body[n++], cage, f);
        body[number].is_open |= bodies->is_open[f] != 0;
        add_volume(&body[number], cage, f, origin_of(cage, &body[number]));
        add_box(&body[number], cage, f);
    }
}

static bool is_inside(const struct body *body, const struct body *outer)
{
    for (int i = 0; i < 3; i++)
        if (!(outer->low[i] < body->low[i] && body->high[i] < outer->high[i]))
            return false;
    return true;
}

/* Finds the largest closed bodies whose normals point outwards. */
static size_t find_outer(const struct body *body, uint32_t n, const struct body **outer)
{
    size_t n_outer = 0;
    for (uint32_t b = 0; b < n; b++) {
        if (body[b].is_open || !(body[b].volume > 0))
            continue;
        size_t at = n_outer < MOST_OUTER ? n_outer++ : MOST_OUTER;
        for (; at > 0 && outer[at - 1]->volume < body[b].volume; at--)
            if (at < MOST_OUTER)
                outer[at] = outer[at - 1];
        if (at < MOST_OUTER)
            outer[at] = &body[b];
    }
    return n_outer;
}

bool bodies_inside_out(const struct bodies *bodies, uint32_t *count, uint32_t *first)
{
    uint32_t *number_of = malloc((bodies->cage->n_faces + 1) * sizeof *number_of);
    uint32_t n = number_of ? number_bodies(bodies, number_of) : 0;
    struct body *body = number_of ? calloc((size_t)n + 1, sizeof *body) : NULL;
    const struct body *outer[MOST_OUTER];
    size_t n_outer = 0;
    *count = 0;
    if (body) {
        measure(bodies, number_of, body);
        n_outer = find_outer(body, n, outer);
    }
    for (uint32_t b = 0; body && b < n; b++) {
        bool counts = !body[b].is_open && body[b].volume < -LEAST_VOLUME * body[b].parts;
        for (size_t i = 0; counts && i < n_outer; i++)
            counts = !is_inside(&body[b], outer[i]);
        if (counts && (*count)++ == 0)
            *first = body[b].first;
    }
    free(number_of);
    free(body);
    return body != NULL;
}
