/* test_patterns SHEEN PLANE.obj: patterns whose edges cross each other, and lights that end within
 * the picture, against many samples for each pixel. The plane mirrors them without bending, so the
 * remaining error is that of the filter: below one part in a hundred. */
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/oracle/area_setups.h"
#include "tests/oracle/folder.h"
#include "tests/oracle/samples.h"
#include "tests/oracle/vec.h"
#include "tests/oracle/verdict.h"
#include "tests/oracle/view.h"

namespace
{

/* samples for each pixel, in each direction */
const int width_px = 96, height_px = 64, samples = 32;
/* In 1/255: a hundredth of a pixel's area, which the sRGB curve enlarges where little of the area
 * is bright, and half a step of the colour. */
const double max_error = 3.0 + 0.5;
/* For patterns with edges along the rows of samples, where the samples themselves are inexact, and
 * for images, which are sums of samples: 99 of 100 pixels. */
const double max_p99 = 4, max_image_p99 = 8;
const double px = 1.0 / height_px; /* in units: the camera's picture is one unit high */

struct scene {
    std::string name;
    std::vector<std::string> options;
};

/* From straight above: a pixel is a square of the plane, and the reflected ray goes straight up. */
const std::vector<std::string> camera = {"--eye", "0,0,1", "--target", "0,0,0",
                                         "--up",  "0,1,0", "--ortho",  "1"};

void add_light(std::vector<std::string> *options, vec3 centre, vec3 u, vec3 v,
               const std::string &pattern)
{
    options->insert(options->end(),
                    {"--light", "rectangle", "--light-center", comma_separated(centre), "--light-u",
                     comma_separated(u), "--light-v", comma_separated(v), "--pattern", pattern});
}

/* A pattern on a light that fills the picture; with `shear`, its sides are not at right angles. */
scene pattern_scene(const std::string &pattern, double shear)
{
    scene scene = {pattern + (shear > 0 ? ", sheared" : ""), camera};
    add_light(&scene.options, {0.003, 0.001, 2}, {4, 0, 0}, {4 * shear, 4, 0}, pattern);
    return scene;
}

/* White lights on black, so small that most of their area is near corners, but wider than a
 * pixel. */
scene corner_scene()
{
    const double deg = M_PI / 180;
    scene scene = {"lights of few pixels", camera};
    int n = 0;
    for (vec3 size : {vec3{7, 5, 90}, vec3{4, 4, 90}, vec3{3, 2, 90}, vec3{2.4, 2, 60},
                      vec3{12, 1.6, 90}, vec3{16, 4, 30}, vec3{5, 3, 130}, vec3{1.5, 1.5, 90}}) {
        double a = (17 + 23 * n) * deg, b = a + size.z * deg;
        vec3 centre = {px * (-36.3 + 24.2 * (n % 4)), px * (-14.6 + 27.3 * (n / 4)), 2};
        add_light(&scene.options, centre, (size.x * px) * vec3{std::cos(a), std::sin(a), 0},
                  (size.y * px) * vec3{std::cos(b), std::sin(b), 0}, "stripes:bg=#ffffff");
        n++;
    }
    scene.options.insert(scene.options.end(), {"--miss", "#000000"});
    return scene;
}

/* `image`: the path of a file. */
std::vector<scene> scenes(const std::string &image)
{
    return {
        corner_scene(),
        pattern_scene("lattice:count=40,rotation=30", 0),
        pattern_scene("lattice:count=120,rotation=20,duty=0.2", 0.8),
        pattern_scene("lattice:count=250,rotation=30", 0),
        pattern_scene("lattice:count=600,rotation=20,duty=0.2", 0.8),
        pattern_scene("lattice:count=120,rotation=45,soft=0.3", 0),
        pattern_scene("lattice:count=600,rotation=45,soft=0.3", 0.8),
        pattern_scene("lines:at=0.46/0.5/0.52,rotation=20,width=0.006,soft=0.3", 0),
        pattern_scene("lines:at=0.46/0.5/0.52,rotation=20,width=0.02,soft=1", 0),
        pattern_scene("circles:count=4,duty=0.3", 0),
        pattern_scene("circles:count=40", 0),
        pattern_scene("circles:count=100,duty=0.3,soft=0.5", 0.8),
        pattern_scene("circles:count=250", 0.8),
        pattern_scene("circles:count=500,duty=0.3", 0),
        pattern_scene("rainbow:count=40,rotation=30", 0),
        pattern_scene("rainbow:count=300,rotation=20", 0.8),
        pattern_scene("image:" + image, 0),
        pattern_scene("image:" + image, 0.8),
        pattern_scene("image:" + image, 2.5),
    };
}

void judge(const std::string &sheen, const std::string &model, scene scene, verdict *verdict)
{
    picture filtered = render_picture(sheen, model, width_px, height_px, scene.options);
    scene.options.insert(scene.options.end(), {"--filter", "off"});
    std::vector<double> truth = averaged(
        render_picture(sheen, model, width_px * samples, height_px * samples, scene.options),
        samples);
    std::vector<double> error = differences(filtered, truth);
    size_t mixed = 0;
    for (size_t i = 0; i < error.size(); i++)
        mixed += truth[3 * i] > 0.5 && truth[3 * i] < 254.5;
    double worst = quantile(error, 1), p99 = quantile(error, 0.99), mean = mean_of(error);
    std::printf("%-66s %5zu mixed pixels, error %.3f on average, %.2f of 99 in 100, %.2f at most\n",
                scene.name.c_str(), mixed, mean, p99, worst);
    verdict->check(mixed > 50, scene.name + ": no pixel shows both colours");
    if (scene.name.find("image") == 0)
        verdict->at_most(p99, max_image_p99, scene.name + ": error in 1/255");
    else if (scene.name.find("circles") == 0)
        verdict->at_most(p99, max_p99, scene.name + ": error in 1/255");
    else
        verdict->at_most(worst, max_error, scene.name + ": error in 1/255");
}

} // namespace

int main(int argc, char **argv)
{
    if (argc != 3) {
        std::fprintf(stderr, "usage: test_patterns SHEEN PLANE.obj\n");
        return 2;
    }
    verdict verdict;
    temporary_folder folder;
    chance chance(1);
    std::string image = make_image(&chance, folder.file("image.png"), true)->path;
    for (const scene &scene : scenes(image))
        try {
            judge(argv[1], argv[2], scene, &verdict);
        } catch (const std::exception &failure) {
            verdict.check(false, failure.what());
        }
    return verdict.finish();
}
