/* test_isophotes SHEEN BODY: lines must lie where closed forms put them. First, isophotes of the
 * paraboloid z = (x^2 + y^2) / 2, which Catmull-Clark surfaces reproduce exactly, as they include
 * uniform bicubic B-splines; its normal is (-x, -y, 1), so the isophotes are circles. Second, a
 * closed body under a tunnel of lines, whose closed form is applied to libosd's surface. */
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "tests/oracle/cage_file.h"
#include "tests/oracle/frame_loop.h"
#include "tests/oracle/lines.h"
#include "tests/oracle/srgb.h"

namespace
{

const int width_px = 320, height_px = 240;
const double max_off_px = 0.02;
/* as linear light: where the sRGB curve is steepest */
const double colour_rounding = 2.3 * 0.5 / 255;
const int lattice_points = 610, lattice_step = 377; /* of a Fibonacci lattice over the pixel */
/* of the share of a pixel on one side of an edge */
const double lattice_error = 0.004;

/* A grid of control points at (i, j) h. Control values i^2 - 1/3 give the B-spline t^2. */
void write_paraboloid(const std::string &path)
{
    const int n = 6;
    const double h = 0.25;
    loose_cage cage;
    for (int j = -n; j <= n; j++)
        for (int i = -n; i <= n; i++)
            cage.position.push_back({i * h, j * h, 0.5 * h * h * (i * i + j * j - 2.0 / 3)});
    const uint32_t row = 2 * n + 1;
    for (uint32_t j = 0; j + 1 < row; j++)
        for (uint32_t i = 0; i + 1 < row; i++) {
            uint32_t a = j * row + i;
            cage.faces.push_back({a, a + 1, a + row + 1, a + row});
        }
    cage.boundary = CAGE_BOUNDARY_NONE;
    cage.write_obj(path);
}

/* Where the pixel's ray leaves the bowl; the eye is within the bowl. */
vec3 paraboloid_point(const projector &camera, double x, double y)
{
    vec3 o, d;
    camera.ray(x, y, &o, &d);
    double a = 0.5 * (d.x * d.x + d.y * d.y), b = o.x * d.x + o.y * d.y - d.z;
    double c = 0.5 * (o.x * o.x + o.y * o.y) - o.z;
    /* the quadratic's c is below 0, so this root exists also for a = 0 */
    double t = -2 * c / (b + std::sqrt(b * b - 4 * a * c));
    return o + t * d;
}

double paraboloid_s(const projector &camera, double x, double y)
{
    vec3 p = paraboloid_point(camera, x, y);
    return std::atan(std::hypot(p.x, p.y)) / M_PI;
}

/* The mean of the linear light over the pixel at (x, y). */
double paraboloid_colour(const projector &camera, const line_pattern &pattern, int x, int y)
{
    double sum = 0;
    for (int k = 0; k < lattice_points; k++) {
        double across = (k + 0.5) / lattice_points;
        double down = std::fmod((double)k * lattice_step, lattice_points) / lattice_points;
        light_hit hit;
        hit.s = paraboloid_s(camera, x + across, y + down);
        hit.t = 0.5;
        hit.width = 180;
        hit.height = 360;
        sum += pattern_colour(pattern, hit).g;
    }
    return sum / lattice_points;
}

/* Whether all pixels around it are on the surface. */
bool is_inner(const planes &planes, int x, int y)
{
    if (x < 1 || y < 1 || x + 1 >= planes.width_px || y + 1 >= planes.height_px)
        return false;
    for (int k = 0; k < 9; k++)
        if (!planes.hit((size_t)(y + k / 3 - 1) * (size_t)planes.width_px +
                        (size_t)(x + k % 3 - 1)))
            return false;
    return true;
}

void judge_paraboloid(const std::string &sheen, bool orthographic, verdict *verdict)
{
    temporary_folder folder;
    std::string path = folder.file("paraboloid.obj");
    write_paraboloid(path);
    view view;
    view.name = orthographic ? "ortho" : "oblique";
    view.width_px = width_px;
    view.height_px = height_px;
    view.eye = {0.4, -0.9, 4.5};
    view.target = {0.02, 0.01, 0.3};
    view.up = {0.1, 1, 0.2};
    view.fov_deg = 30;
    view.orthographic = orthographic;
    view.ortho_height = 2.2;
    line_setup setup;
    setup.family = line_family::isophote;
    setup.has_axis = true;
    setup.axis = {0, 0, 2};
    line_pattern pattern;
    pattern.count = 18;
    pattern.duty = 0.4;
    /* within 10 px of the apex there is no edge, because s has no gradient there */
    pattern.offset = 0.5;
    setup.lights = {{line_light_kind::plane, false, {0, 0, 9}, {1, 0, 0}, {0, 1, 0}, pattern}};
    planes planes;
    int exit_code;
    std::string wrong =
        render_view(sheen, path, &view, "P,N,ptex,light", line_options(setup), &planes, &exit_code);
    if (!verdict->check(wrong.empty(), wrong))
        return;
    projector camera(view);
    std::vector<double> off_px, off_colour;
    for (int y = 0; y < height_px; y++)
        for (int x = 0; x < width_px; x++) {
            size_t i = (size_t)y * width_px + (size_t)x;
            if (!is_inner(planes, x, y))
                continue;
            double s = paraboloid_s(camera, x + 0.5, y + 0.5);
            double right = paraboloid_s(camera, x + 0.51, y + 0.5);
            double down = paraboloid_s(camera, x + 0.5, y + 0.51);
            off_px.push_back(std::fabs(planes.s[i] - s) * 0.01 / std::hypot(right - s, down - s));
            double colour = paraboloid_colour(camera, pattern, x, y);
            off_colour.push_back(std::fabs(light_of((double)planes.green[i]) - colour));
        }
    double worst_px = quantile(off_px, 1), worst_colour = quantile(off_colour, 1);
    std::printf("paraboloid %-8s %6zu px | s off %.1e px | colour off %.2f/255, p99.9 %.2f/255\n",
                view.name.c_str(), off_px.size(), worst_px, 255 * worst_colour,
                255 * quantile(off_colour, 0.999));
    std::string what = "paraboloid " + view.name + ": ";
    verdict->check(off_px.size() > 20000, what + "too few pixels");
    verdict->at_most(worst_px, max_off_px, what + "isophotes off (px)");
    /* If an edge is displaced by this distance, its pixel's share changes by at most 1.42 times
     * that. */
    verdict->at_most(worst_colour, 1.42 * max_off_px + colour_rounding + lattice_error,
                     what + "filtered colour off");
}

void judge_tunnel(const std::string &sheen, const std::string &path, verdict *verdict)
{
    model model = read_model(path);
    double radius = 0.5 * model.diagonal();
    for (view view : model_views(model, width_px, height_px)) {
        if (view.chosen_by_sheen)
            continue;
        line_light tunnel;
        tunnel.kind = line_light_kind::tunnel;
        tunnel.centre = model.middle() + radius * vec3{0.1, 0.05, 0.2};
        tunnel.u = (3 * radius) * normalized({0.1, 0.2, 1});
        tunnel.v = radius * vec3{1, 0.3, 0.1};
        line_setup setup;
        setup.lights = {tunnel};
        planes planes;
        int exit_code;
        std::string wrong = render_view(sheen, path, &view, "P,N,ptex,light,dlight",
                                        line_options(setup), &planes, &exit_code);
        if (!verdict->check(wrong.empty(), wrong))
            continue;
        line_tracer tracer(setup, view);
        std::vector<double> off_px;
        for (size_t i = 0; i < planes.face.size(); i++) {
            osd_sample sample;
            if (!planes.hit(i) || !osd_oracle_is_exact(planes.u[i], planes.v[i]) ||
                !model.oracle->evaluate(planes.face[i], planes.u[i], planes.v[i], &sample))
                continue;
            light_hit hit = tracer.meet(sample.p, sample.normal(), tunnel);
            double slope = std::hypot(planes.dsdx[i], planes.dsdy[i]);
            off_px.push_back(std::fabs(coordinate_difference(planes.s[i], hit.s, true)) / slope);
        }
        double p999 = quantile(off_px, 0.999);
        std::printf("%s %-8s %6zu px | lines of the tunnel off %.1e px p99.9, %.1e at most\n",
                    model.name.c_str(), view.name.c_str(), off_px.size(), p999,
                    quantile(off_px, 1));
        verdict->check(off_px.size() > 5000, view.name + ": too few pixels");
        verdict->at_most(p999, max_off_px, model.name + " " + view.name + ": tunnel p99.9 (px)");
    }
}

} // namespace

int main(int argc, char **argv)
{
    if (argc != 3) {
        std::fprintf(stderr, "usage: test_isophotes SHEEN BODY\n");
        return 2;
    }
    verdict verdict;
    judge_paraboloid(argv[1], true, &verdict);
    judge_paraboloid(argv[1], false, &verdict);
    judge_tunnel(argv[1], argv[2], &verdict);
    return verdict.finish();
}
