#include "tests/oracle/random_cage.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <random>
#include <set>
#include <utility>

namespace
{

using edge = std::pair<uint32_t, uint32_t>; /* lower vertex index, higher vertex index */

edge edge_of(uint32_t a, uint32_t b)
{
    return {std::min(a, b), std::max(a, b)};
}

struct maker {
    std::mt19937_64 random;
    loose_cage cage;
    std::string story;
    std::vector<uint32_t> middles; /* inner vertices of spines, where several sheets meet */

    explicit maker(uint64_t seed) : random(seed)
    {
    }

    double unit() /* [0, 1) */
    {
        return std::uniform_real_distribution<double>(0, 1)(random);
    }
    bool chance(double p)
    {
        return unit() < p;
    }
    int between(int least, int most)
    {
        return least + (int)(unit() * (most - least + 1));
    }
    vec3 offset(double size)
    {
        return {size * (2 * unit() - 1), size * (2 * unit() - 1), size * (2 * unit() - 1)};
    }
    template <class T> const T &any(const std::vector<T> &list)
    {
        return list[(size_t)(unit() * (double)list.size())];
    }

    uint32_t add(vec3 p)
    {
        cage.position.push_back(p);
        return (uint32_t)cage.position.size() - 1;
    }
    /* Faces between rows of vertices; at(x, y) is a vertex for x in 0..nx and y in 0..ny. */
    void add_grid(int nx, int ny, const std::function<uint32_t(int, int)> &at)
    {
        for (int y = 0; y < ny; y++)
            for (int x = 0; x < nx; x++)
                cage.faces.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)});
    }

    std::map<edge, int> count_edges() const
    {
        std::map<edge, int> uses;
        for (const std::vector<uint32_t> &face : cage.faces)
            for (size_t k = 0; k < face.size(); k++)
                uses[edge_of(face[k], face[(k + 1) % face.size()])]++;
        return uses;
    }
    std::vector<edge> list_edges() const
    {
        std::vector<edge> list;
        for (const auto &use : count_edges())
            list.push_back(use.first);
        return list;
    }

    uint32_t vertex()
    {
        if (!middles.empty() && chance(0.4))
            return any(middles);
        return any(any(cage.faces));
    }
    /* A walk along edges that visits no vertex twice. */
    std::vector<uint32_t> walk(uint32_t from, int steps)
    {
        std::vector<edge> edges = list_edges();
        std::vector<uint32_t> path = {from};
        for (int i = 0; i < steps; i++) {
            std::vector<uint32_t> next;
            for (const edge &e : edges)
                for (uint32_t to : {e.first, e.second})
                    if (to != path.back() && edge_of(to, path.back()) == e &&
                        std::find(path.begin(), path.end(), to) == path.end())
                        next.push_back(to);
            if (next.empty())
                break;
            path.push_back(any(next));
        }
        return path;
    }

    /* --- basic shapes --- */

    void sheet()
    {
        int nx = between(1, 5), ny = between(1, 5);
        std::vector<uint32_t> v;
        for (int y = 0; y <= ny; y++)
            for (int x = 0; x <= nx; x++)
                v.push_back(add({(double)x, (double)y, 0.4 * std::sin(x + 2 * y)}));
        add_grid(nx, ny, [&](int x, int y) { return v[(size_t)(y * (nx + 1) + x)]; });
        story = "sheet";
    }
    void torus()
    {
        int n = between(3, 7), m = between(3, 5);
        std::vector<uint32_t> v;
        for (int y = 0; y < m; y++)
            for (int x = 0; x < n; x++) {
                double a = 2 * M_PI * x / n, b = 2 * M_PI * y / m, r = 2 + std::cos(b);
                v.push_back(add({r * std::cos(a), r * std::sin(a), std::sin(b)}));
            }
        add_grid(n, m, [&](int x, int y) { return v[(size_t)(y % m * n + x % n)]; });
        story = "torus";
    }
    /* A sphere with triangles at its poles. */
    void sphere()
    {
        int n = between(3, 8), m = between(2, 4);
        std::vector<uint32_t> v;
        for (int y = 1; y < m; y++)
            for (int x = 0; x < n; x++) {
                double a = 2 * M_PI * x / n, b = M_PI * y / m;
                v.push_back(add({1.5 * std::sin(b) * std::cos(a), 1.5 * std::sin(b) * std::sin(a),
                                 -1.5 * std::cos(b)}));
            }
        auto at = [&](int x, int y) { return v[(size_t)(y * n + x % n)]; };
        add_grid(n, m - 2, at);
        uint32_t south = add({0, 0, -1.5}), north = add({0, 0, 1.5});
        for (int x = 0; x < n; x++) {
            cage.faces.push_back({south, at(x + 1, 0), at(x, 0)});
            cage.faces.push_back({north, at(x, m - 2), at(x + 1, m - 2)});
        }
        story = "sphere";
    }
    void fan(uint32_t centre, int sectors, bool closed)
    {
        int rays = closed ? sectors : sectors + 1;
        vec3 middle = cage.position[centre], turn = offset(1);
        double step = (closed ? 2 * M_PI : std::fmin(M_PI, 1.2 * sectors)) / sectors;
        std::vector<uint32_t> rim;
        for (int k = 0; k < 2 * sectors + !closed; k++) {
            double r = k % 2 ? 1.35 : 1, a = k * step / 2;
            rim.push_back(add(middle + vec3{r * std::cos(a), r * std::sin(a), 0.6} + 0.5 * turn));
        }
        auto at = [&](int k) { return rim[(size_t)k % rim.size()]; };
        for (int k = 0; k < rays - !closed; k++)
            cage.faces.push_back({centre, at(2 * k), at(2 * k + 1), at(2 * k + 2)});
    }
    /* Pages that share a spine, each with a random winding. */
    void book()
    {
        int pages = between(2, 5), length = between(2, 4), width = between(1, 3);
        std::vector<uint32_t> spine;
        for (int y = 0; y <= length; y++)
            spine.push_back(add({0, 0, (double)y}));
        middles.assign(spine.begin() + 1, spine.end() - 1);
        for (int page = 0; page < pages; page++) {
            double a = 2 * M_PI * page / pages;
            std::vector<uint32_t> v;
            for (int y = 0; y <= length; y++)
                for (int x = 0; x <= width; x++)
                    v.push_back(x ? add({x * std::cos(a), x * std::sin(a), (double)y})
                                  : spine[(size_t)y]);
            bool back = chance(0.5);
            add_grid(width, length, [&](int x, int y) {
                return v[(size_t)(y * (width + 1) + (back ? width - x : x))];
            });
        }
        story = "book of " + std::to_string(pages);
    }
    /* Random cubes of a lattice, without the faces between them. Two cubes may share only an edge
     * or a vertex. */
    void cubes()
    {
        const int n = 3, m = 2;
        double filled = 0.25 + 0.35 * unit();
        bool cube[n + 2][n + 2][m + 2] = {};
        std::map<int, uint32_t> at;
        for (int i = 0; i < n * n * m; i++)
            cube[1 + i % n][1 + i / n % n][1 + i / n / n] = chance(filled);
        cube[1][1][1] = true;
        auto lattice = [&](int x, int y, int z) {
            int key = (z * (n + 2) + y) * (n + 2) + x;
            if (!at.count(key))
                at[key] = add({(double)x, (double)y, (double)z});
            return at[key];
        };
        for (int i = 0; i < n * n * m; i++) {
            int p[3] = {1 + i % n, 1 + i / n % n, 1 + i / n / n};
            for (int axis = 0; cube[p[0]][p[1]][p[2]] && axis < 3; axis++)
                for (int side = 0; side < 2; side++) {
                    int q[3] = {p[0], p[1], p[2]};
                    q[axis] += side ? 1 : -1;
                    if (!cube[q[0]][q[1]][q[2]])
                        cube_side(p, axis, side, lattice);
                }
        }
        for (const auto &use : count_edges())
            if (use.second > 2)
                middles.insert(middles.end(), {use.first.first, use.first.second});
        story = "cubes";
    }
    void cube_side(const int p[3], int axis, int side,
                   const std::function<uint32_t(int, int, int)> &lattice)
    {
        std::vector<uint32_t> face;
        for (int k = 0; k < 4; k++) {
            int corner[3] = {p[0], p[1], p[2]};
            corner[axis] += side;
            corner[(axis + 1) % 3] += k == 1 || k == 2;
            corner[(axis + 2) % 3] += k >= 2;
            face.push_back(lattice(corner[0], corner[1], corner[2]));
        }
        if (!side)
            std::reverse(face.begin(), face.end());
        cage.faces.push_back(face);
    }

    /* --- changes of a shape --- */

    void lose_faces(double share)
    {
        std::vector<std::vector<uint32_t>> left;
        for (const std::vector<uint32_t> &face : cage.faces)
            if (!chance(share))
                left.push_back(face);
        if (!left.empty())
            cage.faces = left;
        story += ", faces lost";
    }
    /* Adds faces along a walk on edges, which become non-manifold if they had two faces. */
    void glue_sheet()
    {
        std::vector<uint32_t> path = walk(vertex(), between(1, 4));
        std::vector<uint32_t> rim;
        vec3 away = offset(1);
        away = (0.9 / std::fmax(length(away), 0.1)) * away;
        for (uint32_t v : path)
            rim.push_back(add(cage.position[v] + away));
        for (size_t k = 0; k + 1 < path.size(); k++)
            cage.faces.push_back({path[k], path[k + 1], rim[k + 1], rim[k]});
        for (size_t k = 1; k + 1 < path.size(); k++)
            middles.push_back(path[k]);
        story += ", a sheet glued to " + std::to_string(path.size() - 1) + " edges";
    }
    void glue_fan()
    {
        bool closed = chance(0.6);
        int sectors = closed ? between(3, 5) : between(1, 3);
        uint32_t centre = !middles.empty() && chance(0.7) ? any(middles) : vertex();
        fan(centre, sectors, closed);
        story += closed ? ", a closed fan glued on" : ", an open fan glued on";
    }
    void split_quads(double share)
    {
        std::vector<std::vector<uint32_t>> split;
        for (const std::vector<uint32_t> &face : cage.faces) {
            if (face.size() != 4 || !chance(share)) {
                split.push_back(face);
                continue;
            }
            split.push_back({face[0], face[1], face[2]});
            split.push_back({face[0], face[2], face[3]});
        }
        cage.faces = split;
        story += ", quads split";
    }
    /* Merges two faces that share an edge, unless the result repeats a vertex. */
    void join_faces()
    {
        size_t a = (size_t)(unit() * (double)cage.faces.size());
        std::vector<uint32_t> first = cage.faces[a];
        std::rotate(first.begin(), first.begin() + between(0, (int)first.size() - 1), first.end());
        for (size_t b = 0; b < cage.faces.size(); b++) {
            std::vector<uint32_t> second = cage.faces[b];
            auto at = std::find(second.begin(), second.end(), first[0]);
            if (a == b || at == second.end())
                continue;
            std::rotate(second.begin(), at, second.end());
            if (second.back() != first[1])
                continue;
            /* from the edge's end around the first face, then from its start around the second */
            std::vector<uint32_t> both(first.begin() + 1, first.end());
            both.insert(both.end(), second.begin(), second.end() - 1);
            if (std::set<uint32_t>(both.begin(), both.end()).size() != both.size())
                continue;
            cage.faces[a] = both;
            cage.faces.erase(cage.faces.begin() + (std::ptrdiff_t)b);
            story += ", faces joined";
            return;
        }
    }
    void turn_face()
    {
        size_t f = (size_t)(unit() * (double)cage.faces.size());
        std::reverse(cage.faces[f].begin(), cage.faces[f].end());
        story += ", a face turned";
    }
    void repeat_face()
    {
        std::vector<uint32_t> face = any(cage.faces);
        cage.faces.push_back(face);
        story += ", a face twice";
    }
    void add_noise()
    {
        double size = 0.25 * unit();
        for (vec3 &p : cage.position)
            p = p + offset(size);
    }

    /* --- tags --- */

    float sharpness()
    {
        if (chance(0.25))
            return CAGE_SHARPNESS_INFINITE;
        return (float)(chance(0.3) ? between(1, 4) : 0.1 + 3.4 * unit());
    }
    void crease()
    {
        std::vector<uint32_t> path = walk(vertex(), between(1, 5));
        bool varies = chance(0.4);
        float value = sharpness();
        for (size_t k = 0; k + 1 < path.size(); k++) {
            value = varies ? sharpness() : value;
            cage.creases.push_back({{path[k], path[k + 1]}, value});
        }
        story += varies ? ", varying crease" : ", crease";
    }
    void add_tags()
    {
        for (int i = between(0, 5); i > 0; i--)
            crease();
        for (int i = chance(0.4) ? between(1, 3) : 0; i > 0; i--)
            cage.corners.push_back({vertex(), sharpness()});
        for (int i = chance(0.15) ? between(1, 3) : 0; i > 0; i--)
            cage.holes.push_back((uint32_t)(unit() * (double)cage.faces.size()));
        cage.boundary = chance(0.5)    ? CAGE_BOUNDARY_EDGE_ONLY
                        : chance(0.75) ? CAGE_BOUNDARY_EDGE_AND_CORNER
                                       : CAGE_BOUNDARY_NONE;
        cage.chaikin = chance(0.3);
        cage.smooth_triangles = chance(0.5);
        static const char *const mode[] = {"", ", edge and corner", ", no boundary"};
        story += mode[cage.boundary];
        story += cage.chaikin ? ", chaikin" : "";
        story += cage.smooth_triangles ? ", smooth triangles" : "";
    }

    void make()
    {
        switch (between(0, 6)) {
        case 0:
            sheet();
            break;
        case 1:
            torus();
            break;
        case 2:
            sphere();
            break;
        case 3: {
            bool closed = chance(0.6);
            fan(add({0, 0, 0}), between(closed ? 3 : 1, 9), closed);
            story = "fan";
            break;
        }
        case 4:
        case 5:
            book();
            break;
        default:
            cubes();
        }
        if (chance(0.3))
            lose_faces(0.15);
        for (int i = chance(0.5) ? between(1, 2) : 0; i > 0; i--)
            glue_sheet();
        if (chance(0.3))
            glue_fan();
        if (chance(0.3))
            split_quads(0.4);
        for (int i = chance(0.3) ? between(1, 3) : 0; i > 0; i--)
            join_faces();
        if (chance(0.1))
            turn_face();
        if (chance(0.05))
            repeat_face();
        add_noise();
        add_tags();
    }
};

} // namespace

random_cage make_random_cage(uint64_t seed)
{
    maker made(seed);
    made.make();
    return {made.cage, made.story};
}
