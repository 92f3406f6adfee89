/* test_far SHEEN MODEL...: a model that is moved 100,000 of its lengths away, together with eye and
 * light, must have the same normal and colour at every pixel. */
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/oracle/cage_file.h"
#include "tests/oracle/frame_loop.h"

namespace
{

const double lengths_away = 1e5;
const double max_normal_p999_rad = 2e-5;
const double max_colour = 2.0 / 255;
/* Near a silhouette, a pixel's centre may fall on either side of it. */
const size_t max_other_px = 12;
const size_t min_hit_px = 20000, min_lit_px = 3000;

struct light {
    vec3 centre, u, v;
};

/* A wide light behind the eye, which most of the visible surface reflects. */
light choose_light(const model &model, const view &view)
{
    vec3 toward = normalized(view.eye - view.target);
    vec3 right = normalized(cross(view.up, toward)), up = cross(toward, right);
    double size = model.diagonal();
    return {view.target + (2 * size) * toward + (0.7 * size) * up, (20 * size) * right,
            (20 * size) * up};
}

bool render(const std::string &sheen, const std::string &path, view *view, const light &light,
            vec3 offset, planes *planes, verdict *verdict)
{
    int exit_code;
    view->eye = view->eye + offset;
    view->target = view->target + offset;
    std::string wrong =
        render_view(sheen, path, view, "P,N,ptex,light",
                    {"--light-center", comma_separated(light.centre + offset), "--light-u",
                     comma_separated(light.u), "--light-v", comma_separated(light.v), "--pattern",
                     "stripes:count=100,duty=0.5"},
                    planes, &exit_code);
    return verdict->check(wrong.empty(), wrong);
}

struct figures {
    size_t hit = 0, lit = 0, other = 0, recoloured = 0;
    double colour = 0;
    std::vector<double> normal_rad, oracle_rad;
};

figures compare(const model &model, const planes &near, const planes &far)
{
    figures f;
    for (size_t i = 0; i < near.face.size(); i++) {
        bool same = near.face[i] == far.face[i];
        /* whether b is the next face across a common edge */
        if (!same && near.hit(i) && far.hit(i))
            same = angle(near.normal(i), far.normal(i)) <= max_normal_p999_rad;
        if (!same) {
            f.other++;
            continue;
        }
        if (!near.hit(i))
            continue;
        f.hit++;
        f.normal_rad.push_back(angle(near.normal(i), far.normal(i)));
        osd_sample truth;
        if (osd_oracle_is_exact(far.u[i], far.v[i]) &&
            model.oracle->evaluate(far.face[i], far.u[i], far.v[i], &truth) && truth.has_normal())
            f.oracle_rad.push_back(angle(far.normal(i), truth.normal()));
        f.lit += std::isfinite(near.s[i]);
        double colour = std::fabs((double)near.green[i] - (double)far.green[i]);
        f.recoloured += !(colour <= max_colour);
        f.colour = colour <= f.colour ? f.colour : colour;
    }
    return f;
}

void judge(const std::string &sheen, const std::string &path, verdict *verdict)
{
    model model = read_model(path);
    loose_cage moved(*model.cage);
    vec3 offset = (lengths_away * model.diagonal()) * normalized({1, -0.7, 0.45});
    for (vec3 &p : moved.position)
        p = p + offset;
    temporary_folder folder;
    std::string moved_path = folder.file("moved.obj");
    moved.write_obj(moved_path);
    for (const view &view : model_views(model, 640, 480)) {
        if (view.chosen_by_sheen)
            continue;
        light light = choose_light(model, view);
        struct view here = view, there = view;
        planes near, far;
        if (!render(sheen, path, &here, light, {}, &near, verdict) ||
            !render(sheen, moved_path, &there, light, offset, &far, verdict))
            continue;
        figures f = compare(model, near, far);
        double n999 = quantile(f.normal_rad, 0.999), o999 = quantile(f.oracle_rad, 0.999);
        std::printf("%-24s %-8s %7zu %7zu | %7.1e %7.1e | %7.1e %7.1e | %6zu %6zu %8.4f\n",
                    model.name.c_str(), view.name.c_str(), f.hit, f.lit, n999,
                    quantile(f.normal_rad, 1), o999, quantile(f.oracle_rad, 1), f.other,
                    f.recoloured, 255 * f.colour);
        std::string what = model.name + " " + view.name + ": ";
        verdict->check(f.hit >= min_hit_px && f.lit >= min_lit_px, what + "too little is seen");
        verdict->at_most(n999, max_normal_p999_rad, what + "normal p99.9 to the unmoved (rad)");
        verdict->at_most(o999, max_normal_p999_rad, what + "normal p99.9 to libosd (rad)");
        verdict->at_most((double)(f.other + f.recoloured), (double)max_other_px,
                         what + "pixels that show another surface or colour");
    }
}

} // namespace

int main(int argc, char **argv)
{
    if (argc < 3) {
        std::fprintf(stderr, "usage: test_far SHEEN MODEL...\n");
        return 2;
    }
    verdict verdict;
    std::printf("%-24s %-8s %7s %7s | %15s | %15s | %s\n", "", "", "", "", "N to unmoved, rad",
                "N to libosd, rad", "pixels");
    std::printf("%-24s %-8s %7s %7s | %7s %7s | %7s %7s | %6s %6s %s\n", "model", "view", "hit px",
                "lit px", "p99.9", "max", "p99.9", "max", "moved", "colour", "most/255");
    for (const std::string &path : list_models(std::vector<std::string>(argv + 2, argv + argc))) {
        try {
            judge(argv[1], path, &verdict);
        } catch (const std::exception &failure) {
            verdict.check(false, failure.what());
        }
        std::fflush(stdout);
    }
    return verdict.finish();
}
