/* test_mirror SHEEN PLANE.obj: a flat cage in z = 0 is a plane mirror. Its normal, the light's
 * (s,t) and the stripes have closed forms, and every edge of a stripe is a straight line of the
 * picture. */
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "tests/oracle/frame_loop.h"

namespace
{

const double max_normal_error = 1e-6; /* rad from (0,0,1) */
/* px: how far from its pixel the place lies to which (s,t) belong */
const double max_light_px = 1e-3;
const double max_bend_px = 1e-3;
const double max_phase_error = 1e-4; /* of a period */
const double stripe_duty = 0.4;

struct rectangle {
    vec3 centre, u, v;
};

/* (s,t) of the point where the ray through (x, y), reflected by z = 0, meets the light's plane; NaN
 * if the ray runs the other way or misses the rectangle. */
bool mirror_light(const projector &camera, const rectangle &light, double x, double y, double *s,
                  double *t)
{
    vec3 origin, direction;
    camera.ray(x, y, &origin, &direction);
    vec3 point = origin - (origin.z / direction.z) * direction;
    vec3 reflected = {direction.x, direction.y, -direction.z};
    vec3 normal = cross(light.u, light.v);
    double distance = dot(normal, light.centre - point) / dot(normal, reflected);
    vec3 offset = point + distance * reflected - light.centre;
    /* u and v need not be perpendicular, so coordinates use the reciprocal vectors. */
    vec3 by_u = cross(light.v, normal), by_v = cross(normal, light.u);
    *s = 0.5 + dot(offset, by_u) / dot(light.u, by_u);
    *t = 0.5 + dot(offset, by_v) / dot(light.v, by_v);
    return distance > 0 && *s >= 0 && *s <= 1 && *t >= 0 && *t <= 1;
}

struct scene {
    view camera;
    rectangle light;
    int stripe_count;
};

struct figures {
    size_t hit = 0, on_light = 0, wrong_miss = 0, wrong_colour = 0, edges = 0;
    double normal = 0, height = 0, bend_px = 0;
    std::vector<double> light_px, phase;
};

/* s and t of every pixel against the closed form. A pixel within 1e-5 of the rectangle's edge may
 * lie on either side. */
void measure_light(const projector &camera, const scene &scene, const planes &planes, figures *f)
{
    const rectangle &light = scene.light;
    for (size_t i = 0; i < planes.face.size(); i++) {
        if (!planes.hit(i))
            continue;
        f->hit++;
        f->normal = std::fmax(f->normal, angle(planes.normal(i), {0, 0, 1}));
        f->height = std::fmax(f->height, std::fabs((double)planes.pz[i]));
        double s, t, x = (double)(i % (size_t)planes.width_px) + 0.5;
        double y = (double)(i / (size_t)planes.width_px) + 0.5;
        bool expected = mirror_light(camera, light, x, y, &s, &t);
        bool found = std::isfinite(planes.s[i]) && std::isfinite(planes.t[i]);
        double inside = std::fmin(std::fmin(s, 1 - s), std::fmin(t, 1 - t));
        if (std::fabs(inside) < 1e-5)
            continue;
        f->wrong_miss += expected != found;
        if (!expected || !found)
            continue;
        f->on_light++;
        f->phase.push_back(std::fabs(planes.s[i] - s) * scene.stripe_count);
        double right_s, right_t, down_s, down_t;
        mirror_light(camera, light, x + 1, y, &right_s, &right_t);
        mirror_light(camera, light, x, y + 1, &down_s, &down_t);
        double by_s = std::fabs(planes.s[i] - s) / std::hypot(right_s - s, down_s - s);
        double by_t = std::fabs(planes.t[i] - t) / std::hypot(right_t - t, down_t - t);
        f->light_px.push_back(std::fmax(by_s, by_t));
    }
}

struct point {
    double x, y;
};

/* Where the cubic through values at -1, 0, 1 and 2 reaches `level`, in [0, 1]; by bisection. */
double crossing(const double value[4], double level)
{
    auto cubic = [&](double x) {
        return -x * (x - 1) * (x - 2) / 6 * value[0] + (x + 1) * (x - 1) * (x - 2) / 2 * value[1] -
               (x + 1) * x * (x - 2) / 2 * value[2] + (x + 1) * x * (x - 1) / 6 * value[3];
    };
    double low = 0, high = 1;
    bool rising = value[2] > value[1];
    for (int i = 0; i < 40; i++) {
        double middle = 0.5 * (low + high);
        ((cubic(middle) < level) == rising ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

/* The largest distance of the points from their best-fitting line. */
double straightness(const std::vector<point> &points)
{
    double n = (double)points.size(), mx = 0, my = 0, xx = 0, xy = 0, yy = 0, worst = 0;
    for (point p : points)
        mx += p.x / n, my += p.y / n;
    for (point p : points) {
        xx += (p.x - mx) * (p.x - mx);
        xy += (p.x - mx) * (p.y - my);
        yy += (p.y - my) * (p.y - my);
    }
    double theta = 0.5 * std::atan2(2 * xy, xx - yy);
    for (point p : points)
        worst = std::fmax(worst,
                          std::fabs((p.x - mx) * std::sin(theta) - (p.y - my) * std::cos(theta)));
    return worst;
}

/* Every stripe edge, located between pixels of a row by s, must be a straight line. */
void measure_edges(const planes &planes, int stripe_count, figures *f)
{
    /* key: twice the period's number, odd for the falling edge */
    std::map<long, std::vector<point>> edges;
    for (int y = 0; y < planes.height_px; y++)
        for (int x = 1; x + 2 < planes.width_px; x++) {
            double value[4];
            for (int k = 0; k < 4; k++)
                value[k] = planes.s[(size_t)y * (size_t)planes.width_px + (size_t)(x + k - 1)];
            if (!std::isfinite(value[0] + value[1] + value[2] + value[3]))
                continue;
            double low = std::fmin(value[1], value[2]), high = std::fmax(value[1], value[2]);
            for (long period = 0; period <= stripe_count; period++)
                for (long falling = 0; falling < 2; falling++) {
                    double level = ((double)period + (falling ? stripe_duty : 0)) / stripe_count;
                    if (level >= low && level < high)
                        edges[2 * period + falling].push_back(
                            {x + 0.5 + crossing(value, level), y + 0.5});
                }
        }
    for (const auto &edge : edges) {
        if (edge.second.size() < 20)
            continue;
        f->edges++;
        f->bend_px = std::fmax(f->bend_px, straightness(edge.second));
    }
}

/* More than a pixel and a half away from edges, all bright pixels have the same colour, all dark
 * ones too, and bright is brighter than dark. */
void measure_colours(const projector &camera, const scene &scene, const planes &planes, figures *f)
{
    const rectangle &light = scene.light;
    float tone[2] = {NAN, NAN};
    for (int y = 2; y < planes.height_px - 2; y++)
        for (int x = 2; x < planes.width_px - 2; x++) {
            size_t i = (size_t)y * (size_t)planes.width_px + (size_t)x;
            double low = INFINITY, high = -INFINITY, s, t;
            bool lit = planes.hit(i);
            for (int corner = 0; corner < 4; corner++) {
                int dx = corner & 1 ? 1 : -1, dy = corner & 2 ? 1 : -1;
                lit = mirror_light(camera, light, x + 0.5 + 1.5 * dx, y + 0.5 + 1.5 * dy, &s, &t) &&
                      planes.hit(i + (size_t)(dx + dy * planes.width_px)) && lit;
                low = std::fmin(low, s * scene.stripe_count);
                high = std::fmax(high, s * scene.stripe_count);
            }
            double phase = low - std::floor(low), width = high - low;
            bool bright = phase + width < stripe_duty;
            bool dark = phase > stripe_duty && phase + width < 1;
            if (!lit || (!bright && !dark))
                continue;
            if (std::isnan(tone[bright]))
                tone[bright] = planes.green[i];
            f->wrong_colour += !(std::fabs(planes.green[i] - tone[bright]) < 0.5 / 255);
        }
    f->wrong_colour += !(tone[1] > tone[0]);
}

std::vector<scene> make_scenes()
{
    view oblique;
    oblique.name = "oblique";
    oblique.eye = {0.4, -3.1, 2.2};
    oblique.target = {0.05, 0, 0};
    oblique.up = {0, 0, 1};
    oblique.fov_deg = 35;
    oblique.width_px = 640;
    oblique.height_px = 480;
    view steep = oblique;
    steep.name = "steep";
    steep.eye = {-0.3, -0.2, 4};
    steep.up = {0.2, 1, 0};
    steep.fov_deg = 28;
    view flat = oblique;
    flat.name = "ortho";
    flat.orthographic = true;
    flat.ortho_height = 1.7;
    view diagonal = oblique;
    diagonal.name = "45 deg";
    diagonal.eye = {0, -3, 3};
    diagonal.target = {0, 0, 0};
    return {{oblique, {{0.2, 3, 3.5}, {5, 0.4, 0.3}, {-0.2, 3.5, -2.5}}, 24},
            {steep, {{0, 0.3, 3}, {3.5, 1, 0}, {-0.7, 3, 0.4}}, 24},
            {flat, {{0.2, 3, 2.5}, {3, 0.4, 0.3}, {-0.2, 3.5, -2.5}}, 24},
            {diagonal, {{0, 3, 3}, {40, 8, 0}, {-2, 8, -8}}, 400}};
}

void judge(const std::string &sheen, const std::string &plane, scene scene, verdict *verdict)
{
    char pattern[64];
    std::snprintf(pattern, sizeof pattern, "stripes:count=%d,duty=%g", scene.stripe_count,
                  stripe_duty);
    planes planes;
    int exit_code;
    std::string wrong = render_view(sheen, plane, &scene.camera, "P,N,ptex,light",
                                    {"--light-center", comma_separated(scene.light.centre),
                                     "--light-u", comma_separated(scene.light.u), "--light-v",
                                     comma_separated(scene.light.v), "--pattern", pattern},
                                    &planes, &exit_code);
    if (!verdict->check(wrong.empty(), wrong))
        return;
    projector camera(scene.camera);
    figures f;
    measure_light(camera, scene, planes, &f);
    measure_edges(planes, scene.stripe_count, &f);
    measure_colours(camera, scene, planes, &f);
    double phase = quantile(f.phase, 0.999);
    double light_px = quantile(f.light_px, 0.999);
    std::printf("%-8s %7zu %8zu | %8.1e %8.1e %8.1e | %5zu %8.1e | %8.1e\n",
                scene.camera.name.c_str(), f.hit, f.on_light, f.normal, f.height, light_px, f.edges,
                f.bend_px, phase);
    std::string what = scene.camera.name + ": ";
    verdict->check(f.on_light > 20000, what + "too few pixels see the light");
    verdict->check(f.edges >= 8, what + "too few stripe edges to judge");
    verdict->at_most(f.normal, max_normal_error, what + "normal (rad)");
    verdict->at_most(f.height, max_normal_error, what + "|z|");
    verdict->at_most(light_px, max_light_px, what + "light s, t p99.9 (px)");
    verdict->at_most(f.bend_px, max_bend_px, what + "bend of a stripe edge (px)");
    verdict->at_most(phase, max_phase_error, what + "phase of a stripe p99.9 (periods)");
    verdict->check(f.wrong_miss == 0, what + std::to_string(f.wrong_miss) +
                                          " pixels on the wrong side of the light's border");
    verdict->check(f.wrong_colour == 0,
                   what + std::to_string(f.wrong_colour) + " pixels of the wrong colour");
}

/* Eight by eight quads on [-1,1] x [-1,1] in z = 0. */
std::string write_plane(const temporary_folder &folder)
{
    std::string path = folder.file("plane.obj");
    std::ofstream file(path);
    const int n = 8;
    for (int j = 0; j <= n; j++)
        for (int i = 0; i <= n; i++)
            file << "v " << 2.0 * i / n - 1 << " " << 2.0 * j / n - 1 << " 0\n";
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++) {
            int a = j * (n + 1) + i + 1;
            file << "f " << a << " " << a + 1 << " " << a + n + 2 << " " << a + n + 1 << "\n";
        }
    return path;
}

} // namespace

int main(int argc, char **argv)
{
    if (argc != 2 && argc != 3) {
        std::fprintf(stderr, "usage: test_mirror SHEEN [PLANE.obj]\n");
        return 2;
    }
    temporary_folder folder;
    std::vector<std::string> given = list_models(std::vector<std::string>(argv + 2, argv + argc));
    std::string plane = given.empty() ? write_plane(folder) : given[0];
    verdict verdict;
    std::printf("%-8s %7s %8s | %8s %8s %8s | %5s %8s | %s\n", "view", "hit px", "light px",
                "N, rad", "|z|", "s,t, px", "edges", "bend, px", "phase");
    for (const scene &scene : make_scenes())
        judge(argv[1], plane, scene, &verdict);
    return verdict.finish();
}
