#include "tests/oracle/cage_file.h"

#include <cstdio>
#include <fstream>
#include <iterator>
#include <stdexcept>

extern "C" {
#include "server/cage/read/read.h"
}

std::shared_ptr<const cage> read_cage_file(const std::string &path)
{
    std::ifstream file(path, std::ios::binary);
    if (!file)
        throw std::runtime_error(path + ": cannot be opened");
    std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    error error;
    std::shared_ptr<struct cage> cage(new struct cage(), [](struct cage *c) {
        cage_finish(c);
        delete c;
    });
    if (!cage_read(cage.get(), bytes.data(), bytes.size(), path.c_str(), &error))
        throw std::runtime_error(path + ": " + error.text);
    return cage;
}

loose_cage::loose_cage(const cage &cage)
    : creases(cage.crease, cage.crease + cage.n_creases),
      corners(cage.corner, cage.corner + cage.n_corners),
      holes(cage.hole, cage.hole + cage.n_holes), boundary(cage.boundary), chaikin(cage.chaikin),
      smooth_triangles(cage.smooth_triangles)
{
    for (size_t i = 0; i < cage.n_vertices; i++)
        position.push_back({cage.position[i][0], cage.position[i][1], cage.position[i][2]});
    for (size_t f = 0; f < cage.n_faces; f++)
        faces.emplace_back(cage.face_vertex + cage.face_start[f],
                           cage.face_vertex + cage.face_start[f + 1]);
}

void loose_cage::write_obj(const std::string &path) const
{
    std::FILE *file = std::fopen(path.c_str(), "w");
    if (!file)
        throw std::runtime_error(path + ": cannot be written");
    for (const vec3 &p : position)
        std::fprintf(file, "v %.17g %.17g %.17g\n", p.x, p.y, p.z);
    for (const std::vector<uint32_t> &face : faces) {
        std::fputc('f', file);
        for (uint32_t v : face)
            std::fprintf(file, " %u", v + 1);
        std::fputc('\n', file);
    }
    static const int mode[] = {2, 1, 0}; /* indexed by cage_boundary */
    std::fprintf(file, "t interpolateboundary 1/0/0 %d\n", mode[boundary]);
    if (chaikin)
        std::fprintf(file, "t creasemethod 0/0/1 chaikin\n");
    if (smooth_triangles)
        std::fprintf(file, "t smoothtriangles 0/0/1 smooth\n");
    for (const cage_crease &c : creases)
        std::fprintf(file, "t crease 2/1/0 %u %u %.9g\n", c.vertex[0], c.vertex[1],
                     (double)c.sharpness);
    for (const cage_corner &c : corners)
        std::fprintf(file, "t corner 1/1/0 %u %.9g\n", c.vertex, (double)c.sharpness);
    for (uint32_t hole : holes)
        std::fprintf(file, "t hole 1/0/0 %u\n", hole);
    if (std::fclose(file) != 0)
        throw std::runtime_error(path + ": cannot be written");
}

solid_cage::solid_cage(const loose_cage &loose) : parts(loose)
{
    uint32_t ptex = 0;
    for (const vec3 &p : parts.position)
        position.push_back({p.x, p.y, p.z});
    face_start.push_back(0);
    for (const std::vector<uint32_t> &face : parts.faces) {
        face_vertex.insert(face_vertex.end(), face.begin(), face.end());
        face_start.push_back((uint32_t)face_vertex.size());
        first_ptex.push_back(ptex);
        ptex += face.size() == 4 ? 1 : (uint32_t)face.size();
    }
    first_ptex.push_back(ptex);
    cage.n_vertices = position.size();
    cage.position = reinterpret_cast<double(*)[3]>(position.data());
    cage.n_faces = parts.faces.size();
    cage.face_start = face_start.data();
    cage.face_vertex = face_vertex.data();
    cage.scheme = CAGE_SCHEME_CATMULL_CLARK;
    cage.boundary = parts.boundary;
    cage.chaikin = parts.chaikin;
    cage.smooth_triangles = parts.smooth_triangles;
    cage.n_creases = parts.creases.size();
    cage.crease = parts.creases.data();
    cage.n_corners = parts.corners.size();
    cage.corner = parts.corners.data();
    cage.n_holes = parts.holes.size();
    cage.hole = parts.holes.data();
}
