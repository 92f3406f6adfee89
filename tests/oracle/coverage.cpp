#include "tests/oracle/coverage.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "tests/oracle/raster.h"

namespace
{

const double depth_slack = 1e-4; /* of the diagonal; the reference consists of flat cells */

/* What the reference shows within one pixel's distance of a pixel's centre. */
struct neighbourhood {
    int hits = 0, misses = 0;
    bool one_face = true, has_face = false; /* has_face: the requested face is among the faces */
    double nearest = INFINITY, farthest = -INFINITY;
};

neighbourhood look_around(const raster &reference, int x_px, int y_px, uint32_t face)
{
    neighbourhood n;
    int cx = raster_factor * x_px + 1, cy = raster_factor * y_px + 1;
    uint32_t first = no_face;
    for (int y = std::max(cy - raster_factor, 0);
         y <= std::min(cy + raster_factor, reference.height - 1); y++)
        for (int x = std::max(cx - raster_factor, 0);
             x <= std::min(cx + raster_factor, reference.width - 1); x++) {
            const raster::sample &s = reference.at(x, y);
            if (s.face == no_face) {
                n.misses++;
                continue;
            }
            if (n.hits++ == 0)
                first = s.face;
            n.one_face = n.one_face && s.face == first;
            n.has_face = n.has_face || s.face == face;
            n.nearest = std::min(n.nearest, s.depth);
            n.farthest = std::max(n.farthest, s.depth);
        }
    return n;
}

struct counts {
    size_t reference_hit = 0, hit = 0;
    size_t differ = 0;      /* pixels whose masks differ */
    size_t holes = 0;       /* not hit, though all of the reference around is hit */
    size_t strays = 0;      /* hit, though none of the reference around is hit */
    size_t wrong_face = 0;  /* shows another face than the only one around */
    size_t wrong_layer = 0; /* lies in front of or behind everything around */
    /* shows another face near a border; counted for the table only */
    size_t face_differs = 0;
    int first_x = -1, first_y = -1; /* the first pixel that is wrong */

    void blame(size_t *count, int x, int y)
    {
        if (first_x < 0)
            first_x = x, first_y = y;
        ++*count;
    }
};

/* Whether a pixel's face passes through the pixel's point, since sheets may coincide. */
bool lies_on_its_face(const model &model, const planes &planes, size_t i)
{
    vec3 p;
    return model.oracle->evaluate(planes.face[i], planes.u[i], planes.v[i], &p) &&
           length(p - planes.position(i)) <= 1e-5 * model.diagonal();
}

void compare_pixel(const model &model, const raster &reference, const planes &planes,
                   const projector &camera, int x, int y, counts *counts)
{
    size_t i = (size_t)y * (size_t)planes.width_px + (size_t)x;
    const raster::sample &centre = reference.centre(x, y);
    bool ours = planes.hit(i), theirs = centre.face != no_face;
    counts->hit += ours;
    counts->reference_hit += theirs;
    counts->differ += ours != theirs;
    if (!ours && !theirs)
        return;
    neighbourhood n = look_around(reference, x, y, planes.face[i]);
    if (!ours) {
        if (n.misses == 0)
            counts->blame(&counts->holes, x, y);
        return;
    }
    if (n.hits == 0) {
        counts->blame(&counts->strays, x, y);
        return;
    }
    counts->face_differs += theirs && planes.face[i] != centre.face;
    if (!n.has_face && n.one_face && n.misses == 0 && !lies_on_its_face(model, planes, i))
        counts->blame(&counts->wrong_face, x, y);
    /* At a silhouette, depth may change by any amount between samples; elsewhere it changes
     * little. */
    double slack = depth_slack * model.diagonal() + n.farthest - n.nearest;
    double depth = camera.project(planes.position(i)).depth;
    if (!(depth >= n.nearest - slack) || (n.misses == 0 && !(depth <= n.farthest + slack)))
        counts->blame(&counts->wrong_layer, x, y);
}

} // namespace

void print_coverage_header()
{
    std::printf("%-28s %-8s %7s %7s %6s | %6s %6s | %6s %6s %6s\n", "", "", "libosd", "sheen",
                "masks", "", "", "faces", "wrong", "wrong");
    std::printf("%-28s %-8s %7s %7s %6s | %6s %6s | %6s %6s %6s\n", "model", "view", "hit px",
                "hit px", "differ", "holes", "strays", "differ", "face", "layer");
}

void judge_coverage(const model &model, const view &view, const planes &planes, verdict *verdict)
{
    raster reference = rasterize(*model.oracle, view);
    projector camera(view);
    counts c;
    for (int y = 0; y < view.height_px; y++)
        for (int x = 0; x < view.width_px; x++)
            compare_pixel(model, reference, planes, camera, x, y, &c);
    std::printf("%-28s %-8s %7zu %7zu %6zu | %6zu %6zu | %6zu %6zu %6zu\n", model.name.c_str(),
                view.name.c_str(), c.reference_hit, c.hit, c.differ, c.holes, c.strays,
                c.face_differs, c.wrong_face, c.wrong_layer);
    char where[48] = "";
    if (c.first_x >= 0)
        std::snprintf(where, sizeof where, ", the first at pixel %d,%d", c.first_x, c.first_y);
    std::string what = model.name + " " + view.name + ": ";
    auto none = [&](size_t count, const char *name) {
        verdict->check(count == 0, what + std::to_string(count) + " " + name + where);
    };
    verdict->check(c.reference_hit > 1000, what + "the reference shows next to nothing");
    none(c.holes, "holes");
    none(c.strays, "pixels hit outside the surface");
    none(c.wrong_face, "pixels of a face that is not visible there");
    none(c.wrong_layer, "pixels before or behind the visible surface");
}
