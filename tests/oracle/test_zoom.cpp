/* test_zoom SHEEN MODEL...: cameras so close to an extraordinary vertex that a pixel is 2^-24 of a
 * face, once by a small distance and once by a narrow field of view. Every pixel must still show
 * the limit surface where the pixel's ray meets it, as repeated local refinement in long double
 * gives it. The cage is moved so that the vertex is at the origin, and its faces are rotated so
 * that the vertex is their corner 0: only then can single precision distinguish P, u and v of every
 * pixel. */
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/oracle/cage_file.h"
#include "tests/oracle/fan.h"
#include "tests/oracle/frame_loop.h"
#include "tests/oracle/local_surface.h"

namespace
{

const double pixel_of_face = 1.0 / (1 << 24);
const double max_residual_px = 0.2;
/* for up to 8 faces; for more */
const double max_normal_p999_rad = 2e-6, max_normal_high_p999_rad = 2e-5;
const double max_curvature_p999 = 1e-4; /* relative to the larger curvature */
/* a curvature times a pixel's size below this counts as zero */
const double flat_per_pixel = 1e-12;
const double max_position_p999_px = 0.05; /* distance of P to the surface at (face, u, v) */
/* If the eye is a face's size away, single precision knows the eye's position to one such pixel
 * only: measured were 1.6 px for P, 0.83 px for (u, v) and 4.1 px for P along the ray. */
const double max_narrow_residual_px = 2, max_narrow_position_px = 6;
const int width_px = 320, height_px = 240, n_levels = 44;
const size_t max_vertices = 5; /* vertices of one model */

struct corner_vertex {
    std::string kind;
    uint32_t vertex;
    size_t n_faces;
};

struct vertex_tags {
    size_t n_faces = 0, n_sharp = 0, n_semisharp = 0, n_open = 0;
    bool tagged = false, hole = false;
    /* another vertex has the same position, so other surface may hide this one */
    bool shared = false;
};

std::vector<vertex_tags> read_tags(const loose_cage &cage)
{
    std::vector<vertex_tags> tags(cage.position.size());
    std::map<std::pair<uint32_t, uint32_t>, int> uses;
    std::set<uint32_t> holes(cage.holes.begin(), cage.holes.end());
    std::map<std::array<double, 3>, uint32_t> first_at;
    for (uint32_t v = 0; v < tags.size(); v++) {
        const vec3 &p = cage.position[v];
        uint32_t first = first_at.insert({{p.x, p.y, p.z}, v}).first->second;
        tags[v].shared = tags[first].shared |= first != v;
    }
    for (uint32_t f = 0; f < cage.faces.size(); f++)
        for (size_t k = 0; k < cage.faces[f].size(); k++) {
            uint32_t a = cage.faces[f][k], b = cage.faces[f][(k + 1) % cage.faces[f].size()];
            tags[a].n_faces++;
            tags[a].hole |= holes.count(f) > 0;
            uses[{std::min(a, b), std::max(a, b)}]++;
        }
    for (const auto &edge : uses)
        for (uint32_t v : {edge.first.first, edge.first.second})
            tags[v].n_open += edge.second != 2;
    for (const cage_crease &c : cage.creases)
        for (uint32_t v : c.vertex)
            (c.sharpness >= CAGE_SHARPNESS_INFINITE ? tags[v].n_sharp : tags[v].n_semisharp)++;
    for (const cage_corner &c : cage.corners)
        tags[c.vertex].tagged = true;
    return tags;
}

/* Chooses a vertex of every kind and number of faces, up to max_vertices. Tips of cones have no
 * normal and are left out. */
std::vector<corner_vertex> choose_vertices(const loose_cage &cage)
{
    std::vector<vertex_tags> tags = read_tags(cage);
    std::map<std::pair<std::string, size_t>, uint32_t> found;
    for (uint32_t v = 0; v < tags.size(); v++) {
        const vertex_tags &t = tags[v];
        if (t.hole || t.tagged || t.shared || t.n_faces == 0 || t.n_sharp + t.n_open > 2)
            continue;
        std::string kind = t.n_open                          ? "boundary"
                           : t.n_sharp == 2                  ? "crease"
                           : t.n_sharp == 1                  ? "dart"
                           : t.n_semisharp && t.n_faces != 4 ? "semi-sharp"
                                                             : "smooth";
        bool regular = kind == "boundary"                     ? t.n_faces == 2
                       : kind == "smooth" || kind == "crease" ? t.n_faces == 4
                                                              : false;
        if (!regular)
            found.insert({{kind, t.n_faces}, v});
    }
    std::vector<corner_vertex> chosen;
    std::map<std::string, size_t> taken; /* first one of every kind, then a second of each */
    for (size_t round = 0; round < max_vertices; round++)
        for (const auto &f : found)
            if (chosen.size() < max_vertices && taken[f.first.first] == round &&
                std::none_of(chosen.begin(), chosen.end(),
                             [&](const corner_vertex &c) { return c.vertex == f.second; })) {
                taken[f.first.first]++;
                chosen.push_back({f.first.first, f.second, f.first.second});
            }
    return chosen;
}

/* Moves the vertex to the origin, and makes it the first corner of its faces. */
loose_cage about_vertex(const loose_cage &cage, uint32_t vertex)
{
    loose_cage out = cage;
    for (std::vector<uint32_t> &face : out.faces) {
        auto at = std::find(face.begin(), face.end(), vertex);
        if (at != face.end())
            std::rotate(face.begin(), at, face.end());
    }
    for (int pass = 0; pass < 2; pass++) { /* the second pass corrects the rounding of the first */
        solid_cage solid(out);
        local_surface surface(solid.cage, vertex, n_levels);
        local_sample s;
        double nearest = std::ldexp(1, 1 - n_levels); /* an n-gon has one level less */
        vec3 origin = out.position[vertex];
        for (size_t f = 0; f < out.faces.size(); f++)
            if (out.faces[f][0] == vertex &&
                surface.evaluate(solid.cage.face_start[f], nearest, nearest, &s))
                origin = s.p;
        for (vec3 &p : out.position)
            p = p - origin;
    }
    return out;
}

struct scene {
    view camera;
    double pixel; /* world units at the target */
    bool whole;   /* so that the surface fills the picture */
    bool narrow;
};

vec3 across(vec3 n)
{
    return normalized(cross(n, std::fabs(n.x) < 0.6 ? vec3{1, 0, 0} : vec3{0, 1, 0}));
}

/* Looks at the vertex, a little off its normal: from nearby, or from a face's size away. */
scene make_scene(const loose_cage &cage, const solid_cage &solid, const local_surface &surface,
                 const corner_vertex &v, bool from_near)
{
    size_t face = 0;
    while (cage.faces[face][0] != v.vertex)
        face++;
    double side = length(cage.position[cage.faces[face][1]] - cage.position[v.vertex]);
    local_sample s;
    if (!surface.evaluate(solid.cage.face_start[face], std::ldexp(1, -20), std::ldexp(1, -20), &s))
        throw std::runtime_error("no surface at the vertex");
    scene scene;
    scene.pixel = side * pixel_of_face;
    scene.whole = v.kind != "boundary";
    scene.narrow = !from_near;
    double height = scene.pixel * height_px, distance = from_near ? 2 * height : side;
    vec3 toward = normalized(s.normal + 0.3 * across(s.normal));
    scene.camera.name = v.kind + (from_near ? " near" : " narrow");
    scene.camera.eye = distance * toward;
    scene.camera.up = across(toward);
    scene.camera.fov_deg = 2 * std::atan(0.5 * height / distance) * 180 / M_PI;
    scene.camera.width_px = width_px;
    scene.camera.height_px = height_px;
    return scene;
}

struct figures {
    size_t hit = 0, elsewhere = 0, compared = 0;
    /* distance from the pixel's ray: of P; of the surface at (face, u, v) */
    double residual_px = 0, place_px = 0;
    std::vector<double> normal_rad, curvature, position_px, depth;
};

figures measure(const scene &scene, const planes &planes, const local_surface &surface,
                const std::map<uint32_t, uint32_t> &corner_of_ptex)
{
    figures f;
    projector camera(scene.camera);
    auto worse = [&](double *worst, vec3 p,
                     size_t i) { /* also true for NaN */
                                 projected q = camera.project(p);
                                 double off = std::hypot(q.x - ((double)(i % width_px) + 0.5),
                                                         q.y - ((double)(i / width_px) + 0.5));
                                 *worst = off <= *worst ? *worst : off;
    };
    for (size_t i = 0; i < planes.face.size(); i++) {
        if (!planes.hit(i))
            continue;
        auto corner = corner_of_ptex.find(planes.face[i]);
        local_sample truth;
        if (corner == corner_of_ptex.end()) {
            f.elsewhere++; /* beyond a boundary other surface is visible, which is not judged */
            continue;
        }
        f.hit++;
        worse(&f.residual_px, planes.position(i), i);
        if (!surface.evaluate(corner->second, planes.u[i], planes.v[i], &truth))
            continue; /* deeper than the reference */
        worse(&f.place_px, truth.p, i);
        f.normal_rad.push_back(angle(planes.normal(i), truth.normal));
        double size = std::fmax(std::fabs(truth.k.least), std::fabs(truth.k.most));
        size = std::fmax(size, flat_per_pixel / scene.pixel);
        double off = std::fmax(std::fabs((double)planes.k_min[i] - truth.k.least),
                               std::fabs((double)planes.k_max[i] - truth.k.most));
        f.curvature.push_back(off / size);
        f.position_px.push_back(length(planes.position(i) - truth.p) / scene.pixel);
        f.depth.push_back(-std::log2(std::fmax(planes.u[i], planes.v[i])));
    }
    return f;
}

void judge_view(const std::string &name, const corner_vertex &v, const scene &scene, figures f,
                verdict *verdict)
{
    size_t all = (size_t)(width_px * height_px);
    double n999 = quantile(f.normal_rad, 0.999), p999 = quantile(f.position_px, 0.999);
    double k999 = quantile(f.curvature, 0.999);
    std::printf("%-20s %-16s %3zu | %6zu %5zu | %4.1f %4.1f | %7.1e %7.1e | %7.1e %7.1e | %7.1e "
                "%7.1e | %7.1e %7.1e\n",
                name.c_str(), scene.camera.name.c_str(), v.n_faces, f.hit, f.elsewhere,
                quantile(f.depth, 0.01), quantile(f.depth, 1), f.residual_px, f.place_px, n999,
                quantile(f.normal_rad, 1), k999, quantile(f.curvature, 1), p999,
                quantile(f.position_px, 1));
    std::string what = name + " " + scene.camera.name + " " + std::to_string(v.n_faces) + ": ";
    verdict->check(scene.whole ? f.hit == all : f.hit > all / 10,
                   what + std::to_string(f.hit) + " pixels hit");
    verdict->check(f.elsewhere == 0 || !scene.whole,
                   what + std::to_string(f.elsewhere) + " pixels on faces that are not here");
    verdict->check(f.normal_rad.size() > f.hit / 2, what + "too few pixels compared");
    double residual = scene.narrow ? max_narrow_residual_px : max_residual_px;
    verdict->at_most(f.residual_px, residual, what + "P off its pixel (px)");
    verdict->at_most(f.place_px, residual, what + "(u, v) off the pixel (px)");
    verdict->at_most(p999, scene.narrow ? max_narrow_position_px : max_position_p999_px,
                     what + "P off the surface p99.9 (px)");
    verdict->at_most(k999, max_curvature_p999, what + "curvature p99.9 (relative)");
    verdict->at_most(n999, v.n_faces <= 8 ? max_normal_p999_rad : max_normal_high_p999_rad,
                     what + "normal p99.9 (rad)");
}

/* Judges both views of one vertex. */
void judge(const std::string &sheen, const std::string &name, const loose_cage &whole,
           const corner_vertex &v, verdict *verdict)
{
    loose_cage loose = about_vertex(whole, v.vertex);
    solid_cage solid(loose);
    local_surface surface(solid.cage, v.vertex, n_levels);
    std::map<uint32_t, uint32_t> corner_of_ptex;
    for (size_t f = 0; f < loose.faces.size(); f++)
        if (loose.faces[f][0] == v.vertex)
            corner_of_ptex[solid.first_ptex[f]] = solid.cage.face_start[f];
    temporary_folder folder;
    std::string file = folder.file("vertex.obj");
    loose.write_obj(file);
    for (bool from_near : {true, false}) {
        scene scene = make_scene(loose, solid, surface, v, from_near);
        planes planes;
        int exit_code;
        std::string wrong =
            render_view(sheen, file, &scene.camera, "P,N,ptex,k", {}, &planes, &exit_code);
        if (verdict->check(wrong.empty(), name + " " + wrong))
            judge_view(name, v, scene, measure(scene, planes, surface, corner_of_ptex), verdict);
    }
    std::fflush(stdout);
}

void judge_model(const std::string &sheen, const std::string &path, verdict *verdict)
{
    loose_cage cage(*read_cage_file(path));
    std::string name = path.substr(path.rfind('/') + 1);
    std::vector<corner_vertex> vertices = choose_vertices(cage);
    verdict->check(!vertices.empty(), name + ": no extraordinary vertex");
    for (const corner_vertex &v : vertices)
        judge(sheen, name, cage, v, verdict);
}

/* Kinds of vertices that models of cars lack. */
std::vector<fan_shape> list_fans()
{
    const float sharp = CAGE_SHARPNESS_INFINITE;
    return {{"smooth", 8, true, {}, 0},
            {"smooth", 12, true, {}, 0},
            {"boundary", 3, false, {}, 0},
            {"boundary", 6, false, {}, 0},
            {"crease", 6, true, {{0, sharp}, {3, sharp}}, 0},
            /* two faces on one side, without further tags */
            {"crease", 5, true, {{0, sharp}, {2, sharp}}, 0},
            {"dart", 6, true, {{0, sharp}}, 0}};
}

} // namespace

int main(int argc, char **argv)
{
    if (argc < 3) {
        std::fprintf(stderr, "usage: test_zoom SHEEN MODEL...\n");
        return 2;
    }
    verdict verdict;
    std::printf("%-20s %-16s %3s | %12s | %9s | %15s | %15s | %15s | %15s\n", "", "", "", "pixels",
                "log2 1/uv", "off the ray, px", "N, rad", "curvature, rel.", "P off surface, px");
    std::printf("%-20s %-16s %3s | %6s %5s | %4s %4s | %7s %7s | %7s %7s | %7s %7s | %7s %7s\n",
                "model", "view", "N", "hit", "else", "p1", "max", "P", "(u,v)", "p99.9", "max",
                "p99.9", "max", "p99.9", "max");
    for (const std::string &path : list_models(std::vector<std::string>(argv + 2, argv + argc))) {
        try {
            judge_model(argv[1], path, &verdict);
        } catch (const std::exception &failure) {
            verdict.check(false, path + ": " + failure.what());
        }
    }
    for (const fan_shape &shape : list_fans()) {
        fan fan(shape, 17);
        corner_vertex v = {shape.name, 0, (size_t)shape.sectors};
        judge(argv[1], "fan", loose_cage(fan.cage), v, &verdict);
    }
    return verdict.finish();
}
