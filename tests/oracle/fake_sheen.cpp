/* fake_sheen render MODEL -o FILE.exr [options of `sheen render`]: a frame of libosd's surface,
 * made on the CPU. It is right except for the faults that FAKE_FAULTS names (comma-separated).
 * self_test.sh uses it in the place of `sheen`, to show that the oracles accept right frames and
 * find faults. */
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>

#include "tests/oracle/fault.h"
#include "tests/oracle/raster.h"
#include "tests/oracle/render.h"
#include "tests/oracle/tables.h"

namespace
{

struct job {
    std::string model, output;
    view camera;
    vec3 light_centre, light_u, light_v;
    double stripe_count = 20, stripe_duty = 0.5;
    bool light = false;
};

vec3 parse_vector(const std::string &text)
{
    vec3 v;
    if (std::sscanf(text.c_str(), "%lf,%lf,%lf", &v.x, &v.y, &v.z) != 3)
        throw std::runtime_error("not a vector: " + text);
    return v;
}

job parse_job(int argc, char **argv)
{
    job job;
    job.model = argv[2];
    std::map<std::string, std::string> options;
    for (int i = 3; i + 1 < argc; i++)
        options[argv[i]] = argv[i + 1]; /* values become keys as well, which has no effect */
    job.output = options["-o"];
    view &view = job.camera;
    if (std::sscanf(options["--size"].c_str(), "%dx%d", &view.width_px, &view.height_px) != 2)
        throw std::runtime_error("no --size");
    view.chosen_by_sheen = !options.count("--eye");
    if (!view.chosen_by_sheen) {
        view.eye = parse_vector(options["--eye"]);
        view.target = parse_vector(options["--target"]);
        view.up = parse_vector(options["--up"]);
        view.orthographic = options.count("--ortho");
        view.ortho_height = std::atof(options["--ortho"].c_str());
        view.fov_deg = std::atof(options["--fov"].c_str());
    }
    job.light = options["--aov"].find("light") != std::string::npos;
    if (job.light) {
        job.light_centre = parse_vector(options["--light-center"]);
        job.light_u = parse_vector(options["--light-u"]);
        job.light_v = parse_vector(options["--light-v"]);
        std::sscanf(options["--pattern"].c_str(), "stripes:count=%lf,duty=%lf", &job.stripe_count,
                    &job.stripe_duty);
    }
    return job;
}

void choose_camera(const model &model, view *view)
{
    view->target = model.middle();
    view->eye = model.middle() + (2 * model.diagonal()) * normalized({0.5, -1, 0.7});
    view->up = {0, 0, 1};
    view->fov_deg = 32;
}

/* One pixel of every plane, NaN and no_face where nothing is hit. */
struct pixel {
    float p[3], n[3], u, v, k[2], s, t, colour;
    uint32_t face;
    float alpha, z;
};

/* Newton's method on the pixel's ray, from the rasterised (u,v); stays within the face. */
osd_sample solve_pixel(const osd_oracle &oracle, const projector &camera, double x, double y,
                       uint32_t face, double *u, double *v)
{
    osd_sample s;
    for (int step = 0;; step++) {
        oracle.evaluate(face, *u, *v, &s);
        if (step == 2)
            return s;
        vec3 origin, d;
        camera.ray(x, y, &origin, &d);
        vec3 h = normalized(cross(d, std::fabs(d.x) < 0.6 ? vec3{1, 0, 0} : vec3{0, 1, 0}));
        vec3 k = cross(d, h), off = s.p - origin;
        double a = dot(h, s.du), b = dot(h, s.dv), c = dot(k, s.du), e = dot(k, s.dv);
        double det = a * e - b * c, f = dot(h, off), g = dot(k, off);
        double du = (e * f - b * g) / det, dv = (a * g - c * f) / det;
        if (!(std::fabs(du) + std::fabs(dv) < 0.1))
            return s;
        *u = std::clamp(*u - du, 0.0, 1.0);
        *v = std::clamp(*v - dv, 0.0, 1.0);
    }
}

void store(float out[3], vec3 v)
{
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
}

/* Where the reflected ray meets the light, and the colour there, as one sample. */
void shade(const job &job, vec3 direction, vec3 p, vec3 n, pixel *pixel)
{
    vec3 r = direction - (2 * dot(direction, n)) * n;
    vec3 m = cross(job.light_u, job.light_v);
    double distance = dot(m, job.light_centre - p) / dot(m, r);
    vec3 q = p + distance * r - job.light_centre;
    vec3 by_u = cross(job.light_v, m), by_v = cross(m, job.light_u);
    double s = 0.5 + dot(q, by_u) / dot(job.light_u, by_u);
    double t = 0.5 + dot(q, by_v) / dot(job.light_v, by_v);
    if (!(distance > 0 && s >= 0 && s <= 1 && t >= 0 && t <= 1))
        return;
    double phase = s * job.stripe_count;
    /* EXR holds linear light */
    pixel->colour = phase - std::floor(phase) < job.stripe_duty ? 1.0f : 0.1f;
    pixel->s = (float)s;
    pixel->t = (float)t;
}

std::vector<pixel> draw(const job &job, const osd_oracle &oracle)
{
    const view &view = job.camera;
    raster picture = rasterize(oracle, view);
    projector camera(view);
    pixel empty = {
        {NAN, NAN, NAN}, {NAN, NAN, NAN}, NAN, NAN, {NAN, NAN}, NAN, NAN, 0, no_face, 1, 0};
    std::vector<pixel> pixels((size_t)view.width_px * (size_t)view.height_px, empty);
    for (int y = 0; y < view.height_px; y++)
        for (int x = 0; x < view.width_px; x++) {
            const raster::sample &hit = picture.centre(x, y);
            if (hit.face == no_face)
                continue;
            pixel &pixel = pixels[(size_t)y * (size_t)view.width_px + (size_t)x];
            double u = hit.u, v = hit.v;
            osd_sample s = solve_pixel(oracle, camera, x + 0.5, y + 0.5, hit.face, &u, &v);
            store(pixel.p, s.p);
            store(pixel.n, s.normal());
            pixel.face = hit.face;
            pixel.u = (float)u;
            pixel.v = (float)v;
            curvatures k = principal_curvatures(s);
            pixel.k[0] = (float)k.least;
            pixel.k[1] = (float)k.most;
            vec3 origin, direction;
            camera.ray(x + 0.5, y + 0.5, &origin, &direction);
            if (job.light)
                shade(job, direction, s.p, s.normal(), &pixel);
        }
    return pixels;
}

/* The first pixel with `wanted` hits among the 11 x 11 pixels around it, or the number of pixels if
 * there is none. */
size_t find_pixel(const std::vector<pixel> &pixels, const view &view, int wanted)
{
    for (int y = 5; y < view.height_px - 5; y++)
        for (int x = 5; x < view.width_px - 5; x++) {
            int hits = 0;
            for (int k = 0; k < 121; k++)
                hits += pixels[(size_t)((y + k / 11 - 5) * view.width_px + x + k % 11 - 5)].face !=
                        no_face;
            if (hits == wanted)
                return (size_t)(y * view.width_px + x);
        }
    return pixels.size();
}

/* Moves the point by about 0.3 px perpendicular to its pixel's ray. */
vec3 moved_aside(const projector &camera, vec3 p, double x, double y)
{
    vec3 origin, ray, aside_origin, aside_ray;
    camera.ray(x, y, &origin, &ray);
    camera.ray(x + 0.3, y, &aside_origin, &aside_ray);
    return p + (aside_origin - origin) + length(p - origin) * (aside_ray - ray);
}

/* Faults that change every 500th pixel a little; each fault has pixels of its own. */
void break_figures(std::vector<pixel> *pixels, const view &view, double diagonal)
{
    projector camera(view);
    for (size_t i = 0; i < pixels->size(); i += 100) {
        pixel &pixel = (*pixels)[i];
        vec3 origin, ray, p = {pixel.p[0], pixel.p[1], pixel.p[2]};
        vec3 n = {pixel.n[0], pixel.n[1], pixel.n[2]};
        double x = (double)(i % (size_t)view.width_px) + 0.5;
        double y = (double)(i / (size_t)view.width_px) + 0.5;
        camera.ray(x, y, &origin, &ray);
        size_t turn = i / 100 % 5;
        if (turn == 0 && has_fault("normal"))
            store(pixel.n, normalized(n + 4e-6 * normalized(cross(n, {0.3, 0.5, 0.8}))));
        if (turn == 1 && has_fault("unit"))
            store(pixel.n, (1 + 1e-6) * n);
        /* moves along the ray, so that the residual does not change */
        if (turn == 2 && has_fault("position"))
            store(pixel.p, p + 3e-6 * diagonal * ray);
        if (turn == 4 && has_fault("curvature"))
            pixel.k[0] -= (float)(2e-4 * std::fmax(1 / diagonal, std::fabs((double)pixel.k[0])));
        if (turn == 3 && has_fault("residual"))
            store(pixel.p, moved_aside(camera, p, x, y));
    }
}

/* Faults of one pixel each. */
void break_pixels(std::vector<pixel> *pixels, const view &view, double diagonal)
{
    size_t inside = find_pixel(*pixels, view, 121), outside = find_pixel(*pixels, view, 0);
    if (inside == pixels->size())
        throw std::runtime_error("no pixel to break");
    const size_t below = (size_t)view.width_px;
    if (has_fault("winding"))
        for (float &n : (*pixels)[inside].n)
            n = -n;
    if (has_fault("face"))
        (*pixels)[inside + below].face ^= 1;
    if (has_fault("range"))
        (*pixels)[inside + 3].u = 1.5f;
    if (has_fault("hole"))
        (*pixels)[inside + 1].face = no_face;
    if (has_fault("stray") && outside < pixels->size())
        (*pixels)[outside] = (*pixels)[inside];
    if (has_fault("layer"))
        (*pixels)[inside + 2].p[0] += (float)(0.2 * diagonal);
    if (has_fault("nan"))
        (*pixels)[inside + 4].n[1] = NAN;
}

void break_light(std::vector<pixel> *pixels, const view &view)
{
    size_t lit = 0;
    for (size_t i = 0; i < pixels->size(); i++) {
        pixel &pixel = (*pixels)[i];
        double x = (double)(i % (size_t)view.width_px), y = (double)(i / (size_t)view.width_px);
        if (has_fault("bend") && x > 0.5 * view.width_px)
            pixel.s += (float)(4e-5 * std::sin(0.05 * y));
        lit = std::isnan(pixel.s) ? lit : i;
        if (has_fault("colour") && i % 1001 == 0)
            pixel.colour = 0.5f;
    }
    if (has_fault("miss"))
        (*pixels)[lit - 5 * (size_t)view.width_px].s = NAN;
}

void print_json(const view &view)
{
    std::printf("{\n  \"camera\": {\"eye\": [%s], \"target\": [%s], \"up\": [%s], ",
                comma_separated(view.eye).c_str(), comma_separated(view.target).c_str(),
                comma_separated(view.up).c_str());
    std::printf("\"%s\": %.17g}\n}\n", view.orthographic ? "ortho_height" : "fov_deg",
                view.orthographic ? view.ortho_height : view.fov_deg);
}

void write_exr(const job &job, const std::vector<pixel> &pixels)
{
    const view &view = job.camera;
    const pixel &first = pixels[0];
    struct {
        const char *name;
        Imf::PixelType type;
        const void *data; /* the first pixel's */
    } channels[] = {
        {"R", Imf::FLOAT, &first.colour},      {"G", Imf::FLOAT, &first.colour},
        {"B", Imf::FLOAT, &first.colour},      {"A", Imf::FLOAT, &first.alpha},
        {"P.X", Imf::FLOAT, &first.p[0]},      {"P.Y", Imf::FLOAT, &first.p[1]},
        {"P.Z", Imf::FLOAT, &first.p[2]},      {"N.X", Imf::FLOAT, &first.n[0]},
        {"N.Y", Imf::FLOAT, &first.n[1]},      {"N.Z", Imf::FLOAT, &first.n[2]},
        {"ptex.face", Imf::UINT, &first.face}, {"ptex.u", Imf::FLOAT, &first.u},
        {"k.min", Imf::FLOAT, &first.k[0]},    {"k.max", Imf::FLOAT, &first.k[1]},
        {"ptex.v", Imf::FLOAT, &first.v},      {"light.s", Imf::FLOAT, &first.s},
        {"light.t", Imf::FLOAT, &first.t},     {"Z", Imf::FLOAT, &first.z},
    };
    Imf::Header header(view.width_px, view.height_px);
    header.compression() = Imf::NO_COMPRESSION;
    Imf::FrameBuffer frame;
    for (const auto &c : channels) {
        bool broken = has_fault("types") && std::strcmp(c.name, "N.X") == 0;
        header.channels().insert(c.name, Imf::Channel(broken ? Imf::HALF : c.type));
        frame.insert(c.name, Imf::Slice(broken ? Imf::HALF : c.type,
                                        static_cast<char *>(const_cast<void *>(c.data)),
                                        sizeof first, sizeof first * (size_t)view.width_px));
    }
    Imf::OutputFile file(job.output.c_str(), header);
    file.setFrameBuffer(frame);
    file.writePixels(view.height_px);
}

} // namespace

int main(int argc, char **argv)
{
    try {
        if (argc < 3)
            throw std::runtime_error("usage: fake_sheen render MODEL -o FILE.exr [options]");
        if (has_fault("refuse"))
            return 3;
        job job = parse_job(argc, argv);
        model model = read_model(job.model);
        if (job.camera.chosen_by_sheen)
            choose_camera(model, &job.camera);
        std::vector<pixel> pixels = draw(job, *model.oracle);
        break_figures(&pixels, job.camera, model.diagonal());
        break_pixels(&pixels, job.camera, model.diagonal());
        break_light(&pixels, job.camera);
        write_exr(job, pixels);
        if (!has_fault("silent"))
            print_json(job.camera);
    } catch (const std::exception &failure) {
        std::fprintf(stderr, "fake_sheen: %s\n", failure.what());
        return 1;
    }
    return 0;
}
