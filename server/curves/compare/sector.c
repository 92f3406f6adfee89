#include "server/curves/compare/sector.h"

#include <math.h>

/* Levels shrink towards the vertex, but not quite in proportion: bounds by some levels are made larger by this share. */
static const double MARGIN = 0.1;
/* A sector that is wider than this, rad, is not bounded by planes. */
static const double WIDEST = 2.5;

/* The directions of a sector in the tangent plane, as angles from the direction `first`. */
struct directions {
    struct vec first, second; /* unit, perpendicular to each other and to the normal */
    double least, most;
    bool has_first;
};

static void add_point(struct corner_sector *sector, struct directions *directions,
                      struct vec from_vertex, bool is_rest)
{
    struct vec n = sector->vertex.n;
    double height = vec_dot(n, from_vertex);
    struct vec flat = vec_mad(from_vertex, -height, n);
    double length = vec_length(flat);
    if (is_rest) {
        sector->least_height = fmin(sector->least_height, height * (1 + MARGIN));
        sector->most_height = fmax(sector->most_height, height * (1 + MARGIN));
    }
    if (!(length > 0))
        return;
    if (!directions->has_first) {
        directions->first = vec_scale(flat, 1 / length);
        directions->second = vec_cross(n, directions->first);
        directions->has_first = true;
    }
    double angle = atan2(vec_dot(directions->second, flat), vec_dot(directions->first, flat));
    directions->least = fmin(directions->least, angle);
    directions->most = fmax(directions->most, angle);
}

/* Adds the nets of the three patches of the level that begins at the square of this side. */
static void add_level(struct corner_sector *sector, struct directions *directions,
                      const struct kept_surface *surface, size_t leaf, double side)
{
    double half = 0.5 * side;
    for (int k = 1; k < 4; k++) {
        struct kept_part part = {k & 1 ? half : 0, k & 2 ? half : 0, half, half, false};
        struct vec net[16];
        kept_surface_net(surface, leaf, &part, net);
        for (int i = 0; i < 16; i++)
            add_point(sector, directions, vec_sub(net[i], sector->vertex.s), side <= sector->width);
    }
}

/* By all levels that are kept, and by four of the rest down to the last one. */
static void bound_leaf(struct corner_sector *sector, const struct kept_surface *surface,
                       size_t leaf)
{
    struct directions directions = {.least = 0, .most = 0};
    double last = ldexp(2, -(int)limit_levels(kept_node(surface, leaf)));
    for (double side = 1; side > sector->width; side *= 0.5)
        add_level(sector, &directions, surface, leaf, side);
    for (int k = 0; k < 4; k++) {
        double side = k < 3 ? ldexp(sector->width, -3 * k) : last;
        add_level(sector, &directions, surface, leaf, fmin(fmax(side, last), sector->width));
    }
    double width = directions.most - directions.least, margin = MARGIN * width + 1e-5;
    if (!(width < WIDEST))
        return;
    double low = directions.least - margin, high = directions.most + margin;
    struct vec first = directions.first, second = directions.second;
    sector->side[0] = vec_mad(vec_scale(first, -sin(low)), cos(low), second);
    sector->side[1] = vec_mad(vec_scale(first, sin(high)), -cos(high), second);
}

static double extent_at(const struct corner_sector *sector, const struct kept_surface *surface,
                        size_t leaf, double side, struct made_levels *made)
{
    struct limit_point at;
    kept_surface_evaluate_again(surface, leaf, side, side, made, &at);
    return vec_length(vec_sub(at.s, sector->vertex.s));
}

void corner_sector_init(struct corner_sector *sector, const struct kept_surface *surface,
                        size_t leaf)
{
    double width = ldexp(1, -(int)surface->leaves[leaf].n_levels);
    *sector = (struct corner_sector){.width = width};
    kept_surface_evaluate(surface, leaf, 0, 0, &sector->vertex);
    sector->extent = extent_at(sector, surface, leaf, width, NULL);
    sector->half_extent = extent_at(sector, surface, leaf, 0.5 * width, NULL);
    if (sector->vertex.has_normal) {
        bound_leaf(sector, surface, leaf);
    } else {
        sector->least_height = -INFINITY;
        sector->most_height = INFINITY;
    }
}

bool corner_sector_clip(const struct corner_sector *sector, struct vec p, struct vec n,
                        double range[2])
{
    struct vec d = vec_sub(p, sector->vertex.s);
    for (int k = 0; k < 2; k++) {
        double at = vec_dot(sector->side[k], d), slope = vec_dot(sector->side[k], n);
        if (slope > 0)
            range[0] = fmax(range[0], -at / slope);
        else if (slope < 0)
            range[1] = fmin(range[1], -at / slope);
        else if (at < 0)
            return false;
    }
    return range[0] <= range[1];
}

double corner_sector_distance(const struct corner_sector *sector, struct vec p, double above)
{
    struct vec d = vec_sub(p, sector->vertex.s);
    double beside = fmax(fmax(-vec_dot(sector->side[0], d), -vec_dot(sector->side[1], d)), 0);
    return sqrt(above * above + beside * beside); /* they are perpendicular to each other */
}

double corner_rest_above(const struct corner_sector *sector, struct vec p)
{
    double height = vec_dot(sector->vertex.n, vec_sub(p, sector->vertex.s));
    return fmax(fmax(height - sector->most_height, sector->least_height - height), 0);
}

double corner_rest_starts(const struct corner_sector *sector, const struct kept_surface *surface,
                          size_t leaf, double away, struct made_levels *made, double starts[3][2])
{
    /* The extents of levels are nearly a geometric sequence. That gives the level, and its extent corrects it. */
    double ratio = fmin(fmax(sector->half_extent / sector->extent, 0.1), 0.9);
    double reach = 1.5 * away / sector->extent;
    int level = reach < 1 ? (int)ceil(log(fmax(reach, 1e-30)) / log(ratio)) : 0;
    level = level < LIMIT_MAX_LEVELS ? level : LIMIT_MAX_LEVELS;
    while (level > 0 &&
           extent_at(sector, surface, leaf, ldexp(sector->width, 1 - level), made) <= 1.5 * away)
        level--;
    while (level < LIMIT_MAX_LEVELS &&
           extent_at(sector, surface, leaf, ldexp(sector->width, -level), made) > 1.5 * away)
        level++;
    const double shares[3][2] = {{0.7, 0.7}, {0.8, 0.2}, {0.2, 0.8}};
    double side = ldexp(sector->width, -level);
    for (int k = 0; k < 3; k++) {
        starts[k][0] = shares[k][0] * side;
        starts[k][1] = shares[k][1] * side;
    }
    return side;
}
