/* test_numbers FLAT MODEL...: random families, lights, eyes and cameras, some of them far or thin.
 * The light plane of each frame is compared with the formulas of shaders/README.md in double
 * precision on the frame's own P and N; rounding to single precision must explain the error.
 * Further, setups of a rotated flat model in which rounding decides at every pixel: all pixels must
 * show the single answer that README.md gives. */
#include <cmath>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/oracle/cage_file.h"
#include "tests/oracle/lines.h"
#include "tests/oracle/look_from.h"
#include "tests/oracle/random_setups.h"
#include "tests/oracle/scene.h"
#include "tests/oracle/verdict.h"

namespace
{

/* odd, so that the target is at the middle pixel's centre */
const int width_px = 65, height_px = 49;
const int n_setups = 200;
const double max_ratio = 4;
/* Pixels at which the rounding of P and N decides whether the light is met. */
const double max_undecided = 0.01;
const size_t min_met = 300; /* pixels of each family and light */
const double ulp = std::ldexp(1, -24);

frame_request request_of(const scene &scene, const seen_setup &asked, bool filtered)
{
    frame_request request = scene.request(width_px, height_px);
    const line_setup &setup = asked.setup;
    look_from(asked.camera, &request);
    request.lines.family = (renderer_line_family)setup.family;
    request.lines.has_direction = setup.has_axis;
    put(setup.axis, request.lines.direction);
    request.lines.eye_kind = (renderer_line_eye_kind)setup.eye_kind;
    put(setup.eye, request.lines.eye);
    const line_light &from = setup.lights[0];
    light &to = request.lights[0];
    to.kind = (light_kind)from.kind;
    to.one_sided = from.one_sided;
    put(from.centre, to.centre);
    put(from.u, to.u);
    put(from.v, to.v);
    request.unfiltered = !filtered;
    request.planes = PLANE_COLOUR | PLANE_POSITION | PLANE_NORMAL | PLANE_LIGHT;
    return request;
}

struct figures {
    size_t setups = 0, seen = 0, met = 0, undecided = 0, wrong = 0;
    size_t coloured = 0; /* black where no light is met */
    double ratio = 0;
};

/* Half a unit in the last place of a coordinate, or of the coordinate's distance from the light's
 * centre. */
double rounding_of(double coordinate)
{
    int exponent;
    std::frexp(std::fmax(0.5, std::fmax(std::fabs(coordinate), std::fabs(coordinate - 0.5))),
               &exponent);
    return std::ldexp(ulp, exponent - 1);
}

/* How far (s,t) moves if P, N and the view of P are wrong by their rounding, and whether the light
 * is met for all values within a few times that rounding. (For a near line eye, P's rounding turns
 * the view by its own amount; for a far one, the view is a unit vector in single precision, like
 * N.) */
struct explained {
    double s = 0, t = 0;
    bool decided = true;
};

explained explain(const line_tracer &tracer, vec3 p, vec3 n, double p_off, const light_hit &hit)
{
    const line_light &light = tracer.setup.lights[0];
    vec3 v = tracer.sight(p, n);
    explained by;
    auto add = [&](const light_hit &one, const light_hit &other) {
        double s = 0, t = 0;
        for (const light_hit &to : {one, other}) {
            by.decided = by.decided && to.met == hit.met;
            s = std::fmax(s, std::fabs(coordinate_difference(to.s, hit.s, hit.s_wraps)));
            t = std::fmax(t, std::fabs(coordinate_difference(to.t, hit.t, hit.t_wraps)));
        }
        by.s = std::hypot(by.s, s / max_ratio);
        by.t = std::hypot(by.t, t / max_ratio);
    };
    for (vec3 step : {vec3{max_ratio, 0, 0}, vec3{0, max_ratio, 0}, vec3{0, 0, max_ratio}}) {
        vec3 dp = p_off * step, d = ulp * step;
        add(tracer.meet(p + dp, n, light), tracer.meet(p - dp, n, light));
        add(tracer.meet(p, n + d, light), tracer.meet(p, n - d, light));
        add(tracer.meet_along(v + d, p, n, light), tracer.meet_along(v - d, p, n, light));
    }
    by.s += rounding_of(hit.s);
    by.t += rounding_of(hit.t);
    return by;
}

void judge_pixel(const line_tracer &tracer, vec3 eye, const float p_at[3], const float n_at[3],
                 const float light[2], figures *f)
{
    vec3 p = {p_at[0], p_at[1], p_at[2]}, n = {n_at[0], n_at[1], n_at[2]};
    if (!finite(n))
        return;
    f->seen++;
    light_hit hit = tracer.meet(p, n, tracer.setup.lights[0]);
    explained by = explain(tracer, p, n, ulp * std::fmax(length(p - eye), length(p)), hit);
    if (!by.decided) {
        f->undecided++;
        return;
    }
    bool found = std::isfinite(light[0]) && std::isfinite(light[1]);
    bool none = std::isnan(light[0]) && std::isnan(light[1]);
    f->wrong += hit.met ? !found : !none;
    if (!found || !hit.met)
        return;
    f->met++;
    double s_off = std::fabs(coordinate_difference((double)light[0], hit.s, hit.s_wraps));
    double t_off = std::fabs(coordinate_difference((double)light[1], hit.t, hit.t_wraps));
    f->ratio = std::fmax(f->ratio, std::fmax(s_off / by.s, t_off / by.t));
}

void describe(const seen_setup &asked)
{
    for (const std::string &option : view_options(asked.camera))
        std::printf(" %s", option.c_str());
    for (const std::string &option : line_options(asked.setup))
        std::printf(" %s", option.c_str());
    std::printf("\n");
}

figures judge_setup(const scene &scene, drawing *drawing, const seen_setup &asked, bool filtered)
{
    frame frame = drawing->render(request_of(scene, asked, filtered));
    line_tracer tracer(asked.setup, asked.camera);
    auto *p = static_cast<const float(*)[3]>(frame.plane[1]);
    auto *n = static_cast<const float(*)[3]>(frame.plane[2]);
    auto *light = static_cast<const float(*)[2]>(frame.plane[4]);
    figures f;
    for (int i = 0; i < width_px * height_px; i++)
        judge_pixel(tracer, asked.camera.eye, p[i], n[i], light[i], &f);
    auto *colour = static_cast<const uint8_t(*)[4]>(frame.plane[0]);
    for (int i = 0; i < width_px * height_px; i++)
        f.coloured += colour[i][0] || colour[i][1] || colour[i][2];
    frame_finish(&frame);
    if (f.wrong || f.ratio > max_ratio) {
        std::printf("  seen %zu met %zu undecided %zu wrong %zu ratio %.3g:", f.seen, f.met,
                    f.undecided, f.wrong, f.ratio);
        describe(asked);
    }
    return f;
}

void add(const figures &f, figures *sum)
{
    sum->setups++;
    sum->seen += f.seen;
    sum->met += f.met;
    sum->coloured += f.coloured;
    sum->undecided += f.undecided;
    sum->wrong += f.wrong;
    sum->ratio = std::fmax(sum->ratio, f.ratio);
}

void print(const std::string &model, const std::string &what, const figures &f)
{
    std::printf("%-10s %-32s %3zu | %7zu %7zu | %6.2f | %5zu %4zu\n", model.c_str(), what.c_str(),
                f.setups, f.seen, f.met, f.ratio, f.undecided, f.wrong);
}

void judge(const figures &f, const std::string &what, verdict *verdict)
{
    verdict->check(f.wrong == 0,
                   what + ": " + std::to_string(f.wrong) + " pixels on the wrong side of a border");
    verdict->at_most(f.ratio, max_ratio, what + ": (s,t) by what rounding explains");
    verdict->at_most((double)f.undecided / (double)f.seen, max_undecided,
                     what + ": share of pixels that rounding decides");
}

const char *const family_names[] = {"reflection", "highlight", "isophote", "zebra", "environment"};
const char *const light_names[] = {"rectangle", "plane", "tunnel", "sphere"};

std::string file_name(const std::string &path)
{
    return path.substr(path.rfind('/') + 1);
}

void judge_model(const std::string &path, unsigned seed, verdict *verdict)
{
    scene scene(read_cage_file(path));
    drawing drawing(scene);
    const double *low = scene.tables.box_min, *high = scene.tables.box_max;
    vec3 diagonal = {high[0] - low[0], high[1] - low[1], high[2] - low[2]};
    vec3 middle = 0.5 * vec3{low[0] + high[0], low[1] + high[1], low[2] + high[2]};
    random_setups setups(middle, length(diagonal), width_px, height_px, seed);
    for (int k = 0; k < 20; k++) {
        figures sum;
        for (int i = 0; i < n_setups / 20; i++)
            add(judge_setup(scene, &drawing,
                            setups.choose((line_family)(k / 4), (line_light_kind)(k % 4)), false),
                &sum);
        std::string what = std::string(family_names[k / 4]) + " " + light_names[k % 4];
        print(file_name(path), what, sum);
        verdict->check(sum.met >= min_met, what + ": too few pixels meet the light");
        judge(sum, what, verdict);
    }
    figures thin;
    for (int i = 0; i < n_setups / 20; i++)
        add(judge_setup(scene, &drawing, setups.choose_thin_tunnel(), false), &thin);
    print(file_name(path), "far, thin tunnel", thin);
    verdict->check(thin.met >= min_met / 10, "far, thin tunnel: too few pixels meet the light");
    judge(thin, "far, thin tunnel", verdict);
}

/* --- setups in which rounding decides at every pixel */

/* A rotated coordinate system, in which no coordinate of the flat model is a round number. */
const vec3 across = normalized({0.8, 0.5, -0.33}),
           normal = normalized(cross(across, {0.1, 0.7, 1})), along = cross(normal, across),
           origin = {0.3, -0.7, 0.21};

vec3 placed(double x, double y, double z)
{
    return origin + x * across + y * along + z * normal;
}

vec3 turned(double x, double y, double z)
{
    return placed(x, y, z) - origin;
}

std::shared_ptr<const struct cage> turned_cage(const std::string &path)
{
    loose_cage loose(*read_cage_file(path));
    for (vec3 &p : loose.position)
        p = placed(p.x, p.y, p.z);
    auto solid = std::make_shared<solid_cage>(loose);
    return {solid, &solid->cage};
}

struct flat_case {
    const char *what;
    bool all; /* whether every pixel meets the light; otherwise none must */
    line_setup setup;
};

line_setup make_setup(line_family family, line_light_kind kind, vec3 centre, vec3 u, vec3 v)
{
    line_setup setup;
    setup.family = family;
    line_light light;
    light.kind = kind;
    light.centre = centre;
    light.u = u;
    light.v = v;
    setup.lights = {light};
    return setup;
}

line_setup seen_from(line_setup setup, line_eye_kind kind, vec3 eye)
{
    setup.eye_kind = kind;
    setup.eye = eye;
    return setup;
}

/* In rotated coordinates the model lies in z = 0, from -1 to 1 in x and y. */
std::vector<flat_case> flat_cases()
{
    const auto reflection = line_family::reflection, highlight = line_family::highlight;
    const auto plane = line_light_kind::plane, tunnel = line_light_kind::tunnel,
               sphere = line_light_kind::sphere;
    const auto point = line_eye_kind::point, from_afar = line_eye_kind::direction;
    const vec3 x = turned(1, 0.3, 0), y = turned(-0.2, 1, 0), z = turned(0, 0, 1);
    const vec3 slant = turned(0.4, -0.3, -1), mirrored = turned(0.4, -0.3, 1);
    line_setup in_plane = make_setup(reflection, plane, placed(3, 1, 0), x, y);
    line_setup normals_in_plane = make_setup(highlight, plane, placed(3, 1, 0), x, y);
    line_setup one_sided = normals_in_plane;
    one_sided.lights[0].one_sided = true;
    line_setup above = make_setup(reflection, plane, placed(0, 0, 2), x, y);
    line_setup standing = make_setup(reflection, plane, placed(4, 0, 0), mirrored, y);
    line_setup wall = make_setup(highlight, plane, placed(4, 0, 0), z, y);
    line_setup pipe = make_setup(highlight, tunnel, placed(0, 0, 0.5), 5 * z, x);
    line_setup along_ray = make_setup(reflection, tunnel, placed(0, 0, 0), 4 * x, mirrored);
    line_setup along_normal = make_setup(highlight, tunnel, placed(0, 0, 0), 4 * x, z);
    line_setup pole = make_setup(reflection, sphere, {}, x, mirrored);
    line_setup globe = make_setup(highlight, sphere, {}, x, y);
    line_setup environment = make_setup(line_family::environment, plane, {}, x, y);
    environment.has_axis = true;
    environment.axis = mirrored;
    line_setup isophote = make_setup(line_family::isophote, plane, {}, x, y);
    isophote.has_axis = true;
    isophote.axis = z;
    line_setup sight = isophote;
    sight.has_axis = false;
    const vec3 beside = placed(3, 0.4, 0), upon = placed(0.1, 0.05, 0), in_it = turned(1, 0.7, 0);
    return {
        {"model in the light's plane", false, in_plane},
        {"the same, seen from afar", false, seen_from(in_plane, from_afar, slant)},
        {"normals from the light's plane", true, normals_in_plane},
        {"the same, one-sided", false, one_sided},
        {"eye in the surface", false, seen_from(above, point, beside)},
        {"view along the surface", false, seen_from(above, from_afar, in_it)},
        {"both in the light's plane", false, seen_from(in_plane, from_afar, in_it)},
        {"rays along the light's plane", false, seen_from(standing, from_afar, slant)},
        {"normals along the light's plane", false, wall},
        {"tunnel, eye in the surface", true, seen_from(pipe, point, beside)},
        {"tunnel, view along the surface", true, seen_from(pipe, from_afar, in_it)},
        {"tunnel along the rays", false, seen_from(along_ray, from_afar, slant)},
        {"tunnel along the normals", false, along_normal},
        {"sphere's pole", true, seen_from(pole, from_afar, slant)},
        {"sphere, eye in the surface", true, seen_from(globe, point, beside)},
        {"environment's pole", true, seen_from(environment, from_afar, slant)},
        {"isophote of the normal", true, isophote},
        {"isophote, eye on the surface", true, seen_from(sight, point, upon)},
        {"sphere, eye on the surface", true, seen_from(globe, point, upon)},
    };
}

void judge_flat(const std::string &path, verdict *verdict)
{
    scene scene(turned_cage(path));
    drawing drawing(scene);
    seen_setup asked;
    asked.camera.eye = placed(0.4, -2.1, 3.3);
    asked.camera.target = placed(0.1, 0.05, 0);
    asked.camera.up = across;
    asked.camera.fov_deg = 30;
    for (const flat_case &one : flat_cases()) {
        asked.setup = one.setup;
        figures sum;
        add(judge_setup(scene, &drawing, asked, true), &sum);
        std::string what = one.what;
        print(file_name(path), what, sum);
        verdict->check(sum.seen > 1000 && sum.met == (one.all ? sum.seen : 0),
                       what + (one.all ? ": not all" : ": not no") + " pixels meet the light");
        verdict->check(one.all || sum.coloured == 0,
                       what + ": " + std::to_string(sum.coloured) + " pixels show the light");
        judge(sum, what, verdict);
    }
}

} // namespace

int main(int argc, char **argv)
{
    if (argc < 3) {
        std::fprintf(stderr, "usage: test_numbers FLAT MODEL...\n");
        return 2;
    }
    verdict verdict;
    std::printf("%-10s %-32s %3s | %7s %7s | %6s | %s\n", "model", "lines", "n", "seen", "met",
                "ratio", "undecided wrong");
    try {
        judge_flat(argv[1], &verdict);
        for (int i = 2; i < argc; i++)
            judge_model(argv[i], (unsigned)i, &verdict);
    } catch (const std::exception &failure) {
        verdict.check(false, failure.what());
    }
    return verdict.finish();
}
