#include "tests/oracle/local_surface.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

namespace
{

const double infinite = CAGE_SHARPNESS_INFINITE;
const int n_rings = 3;
const int nowhere = -1;

struct point {
    long double x = 0, y = 0, z = 0;
};
point operator+(point a, point b)
{
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
point operator-(point a, point b)
{
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
point operator*(long double s, point a)
{
    return {s * a.x, s * a.y, s * a.z};
}
long double inner(point a, point b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
point outer(point a, point b)
{
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
long double norm(point a)
{
    return std::sqrt(inner(a, a));
}
vec3 rounded(point a)
{
    return {(double)a.x, (double)a.y, (double)a.z};
}

using edge_key = std::pair<int, int>;
edge_key key(int a, int b)
{
    return {std::min(a, b), std::max(a, b)};
}

struct mesh {
    std::vector<point> p;
    std::vector<double> sharpness;       /* of the vertices */
    std::vector<std::vector<int>> faces; /* faces at vertex 0 begin with vertex 0 */
    /* for each face at vertex 0: the corner of the cage that it comes from */
    std::vector<uint32_t> corner;
    std::map<edge_key, double> creases; /* sharpness of those edges that have one */
    point origin;                       /* points are relative to this one */

    double crease(edge_key e) const
    {
        auto found = creases.find(e);
        return found == creases.end() ? 0 : found->second;
    }
};

/* The faces at every edge and vertex. An edge with one face is infinitely sharp. */
struct incidence {
    struct edge {
        std::vector<int> faces;
        double sharpness;
        int point; /* index in the refined mesh */
    };
    std::map<edge_key, edge> edges;
    std::vector<std::vector<int>> vertex_faces;
    std::vector<std::set<int>> vertex_ends; /* the other ends of its edges */

    explicit incidence(const mesh &m) : vertex_faces(m.p.size()), vertex_ends(m.p.size())
    {
        for (size_t f = 0; f < m.faces.size(); f++) {
            const std::vector<int> &face = m.faces[f];
            for (size_t k = 0; k < face.size(); k++) {
                int a = face[k], b = face[(k + 1) % face.size()];
                edges[key(a, b)].faces.push_back((int)f);
                vertex_faces[(size_t)a].push_back((int)f);
                vertex_ends[(size_t)a].insert(b);
                vertex_ends[(size_t)b].insert(a);
            }
        }
        for (auto &e : edges) {
            if (e.second.faces.size() > 2)
                throw std::runtime_error("an edge of three and more faces");
            e.second.sharpness = e.second.faces.size() == 1 ? infinite : m.crease(e.first);
        }
    }
};

double child_sharpness(double s)
{
    return s >= infinite ? s : std::max(s - 1, 0.0);
}

enum class rule { smooth, crease, corner };

/* One step of subdivision of the whole mesh. */
class refinement
{
  public:
    explicit refinement(const mesh &coarse) : in(coarse), incident(coarse)
    {
        refine_vertices_later();
        add_face_points();
        add_edge_points();
        move_vertices();
        connect();
    }
    mesh fine;

  private:
    void refine_vertices_later()
    {
        fine.origin = in.origin;
        fine.p.resize(in.p.size());
        for (double s : in.sharpness)
            fine.sharpness.push_back(child_sharpness(s));
    }
    int add(point p)
    {
        fine.p.push_back(p);
        fine.sharpness.push_back(0);
        return (int)fine.p.size() - 1;
    }
    void add_face_points()
    {
        for (const std::vector<int> &face : in.faces) {
            point sum;
            for (int v : face)
                sum = sum + in.p[(size_t)v];
            face_point.push_back(add((1.0L / (long double)face.size()) * sum));
        }
    }
    void add_edge_points()
    {
        for (auto &e : incident.edges) {
            point ends = in.p[(size_t)e.first.first] + in.p[(size_t)e.first.second];
            long double s = std::min(e.second.sharpness, 1.0);
            point sharp = 0.5L * ends, smooth = ends;
            for (int f : e.second.faces)
                smooth = smooth + fine.p[(size_t)face_point[(size_t)f]];
            e.second.point = add(s * sharp + (1 - s) * (0.25L * smooth));
            double child = child_sharpness(e.second.sharpness);
            if (child > 0) {
                fine.creases[key(e.first.first, e.second.point)] = child;
                fine.creases[key(e.first.second, e.second.point)] = child;
            }
        }
    }
    /* The sharp edges at v before or after the step, by their other ends. */
    rule find_rule(int v, bool after, std::vector<int> *ends) const
    {
        ends->clear();
        for (int w : incident.vertex_ends[(size_t)v]) {
            double s = incident.edges.at(key(v, w)).sharpness;
            if ((after ? child_sharpness(s) : s) > 0)
                ends->push_back(w);
        }
        double own = in.sharpness[(size_t)v];
        if ((after ? child_sharpness(own) : own) > 0 || ends->size() > 2)
            return rule::corner;
        return ends->size() == 2 ? rule::crease : rule::smooth;
    }
    point apply(rule r, int v, const std::vector<int> &ends) const
    {
        point s = in.p[(size_t)v], q, mid;
        if (r == rule::corner)
            return s;
        if (r == rule::crease)
            return 0.125L * (6.0L * s + in.p[(size_t)ends[0]] + in.p[(size_t)ends[1]]);
        long double n = (long double)incident.vertex_faces[(size_t)v].size();
        for (int f : incident.vertex_faces[(size_t)v])
            q = q + fine.p[(size_t)face_point[(size_t)f]];
        for (int w : incident.vertex_ends[(size_t)v])
            mid = mid + 0.5L * (s + in.p[(size_t)w]);
        return (1 / n) * ((1 / n) * q + (2 / n) * mid + (n - 3) * s);
    }
    /* The mean of the sharpnesses that become zero in this step. */
    long double run_out(int v) const
    {
        long double sum = 0;
        int n = 0;
        auto count = [&](double s) {
            if (s > 0 && child_sharpness(s) <= 0) {
                sum += s;
                n++;
            }
        };
        count(in.sharpness[(size_t)v]);
        for (int w : incident.vertex_ends[(size_t)v])
            count(incident.edges.at(key(v, w)).sharpness);
        return n ? std::min(sum / n, 1.0L) : 0;
    }
    void move_vertices()
    {
        for (int v = 0; v < (int)in.p.size(); v++) {
            std::vector<int> before, after;
            rule now = find_rule(v, false, &before), next = find_rule(v, true, &after);
            long double w = now == next ? 1 : run_out(v);
            fine.p[(size_t)v] = w * apply(now, v, before) + (1 - w) * apply(next, v, after);
        }
    }
    void connect()
    {
        for (size_t f = 0; f < in.faces.size(); f++) {
            const std::vector<int> &face = in.faces[f];
            size_t n = face.size();
            for (size_t k = 0; k < n; k++) {
                int v = face[k];
                fine.faces.push_back({v, incident.edges[key(v, face[(k + 1) % n])].point,
                                      face_point[f],
                                      incident.edges[key(face[(k + n - 1) % n], v)].point});
                fine.corner.push_back(v == 0 ? in.corner[f] : UINT32_MAX);
            }
        }
    }

    const mesh &in;
    incidence incident;
    std::vector<int> face_point;
};

/* The part of a mesh within n_rings of faces around vertex 0, with vertex 0 moved to the origin. */
mesh trimmed(const mesh &m)
{
    std::set<int> inside = {0};
    std::vector<bool> keep(m.faces.size());
    for (int ring = 0; ring < n_rings; ring++) {
        std::set<int> grown = inside;
        for (size_t f = 0; f < m.faces.size(); f++)
            for (int v : m.faces[f])
                if (inside.count(v)) {
                    keep[f] = true;
                    grown.insert(m.faces[f].begin(), m.faces[f].end());
                    break;
                }
        inside = grown;
    }
    mesh out;
    out.origin = m.origin + m.p[0];
    std::map<int, int> number;
    for (int v : inside) { /* sorted, so that vertex 0 remains 0 */
        number[v] = (int)out.p.size();
        out.p.push_back(m.p[(size_t)v] - m.p[0]);
        out.sharpness.push_back(m.sharpness[(size_t)v]);
    }
    for (size_t f = 0; f < m.faces.size(); f++) {
        if (!keep[f])
            continue;
        out.faces.push_back(m.faces[f]);
        for (int &v : out.faces.back())
            v = number[v];
        out.corner.push_back(m.corner[f]);
    }
    for (const auto &e : m.creases)
        if (inside.count(e.first.first) && inside.count(e.first.second))
            out.creases[key(number[e.first.first], number[e.first.second])] = e.second;
    return out;
}

/* The whole cage, with `vertex` exchanged for vertex 0. */
mesh read_cage(const cage &cage, uint32_t vertex)
{
    if (cage.chaikin || cage.smooth_triangles || cage.boundary == CAGE_BOUNDARY_NONE)
        throw std::runtime_error("rules that the local evaluator does not know");
    auto swapped = [&](uint32_t v) { return (int)(v == vertex ? 0 : v == 0 ? vertex : v); };
    mesh m;
    m.p.resize(cage.n_vertices);
    m.sharpness.resize(cage.n_vertices);
    std::vector<int> n_faces(cage.n_vertices), n_open(cage.n_vertices);
    for (uint32_t v = 0; v < cage.n_vertices; v++) {
        const double *p = cage.position[v];
        m.p[(size_t)swapped(v)] = {p[0], p[1], p[2]};
    }
    for (uint32_t f = 0; f < cage.n_faces; f++) {
        std::vector<int> face;
        uint32_t at = UINT32_MAX;
        for (uint32_t c = cage.face_start[f]; c < cage.face_start[f + 1]; c++) {
            face.push_back(swapped(cage.face_vertex[c]));
            n_faces[(size_t)face.back()]++;
            at = face.back() == 0 ? c : at;
        }
        if (at != UINT32_MAX)
            std::rotate(face.begin(), std::find(face.begin(), face.end(), 0), face.end());
        m.faces.push_back(face);
        m.corner.push_back(at);
    }
    for (size_t i = 0; i < cage.n_creases; i++)
        m.creases[key(swapped(cage.crease[i].vertex[0]), swapped(cage.crease[i].vertex[1]))] =
            (double)cage.crease[i].sharpness;
    for (size_t i = 0; i < cage.n_corners; i++)
        m.sharpness[(size_t)swapped(cage.corner[i].vertex)] = (double)cage.corner[i].sharpness;
    for (size_t v = 0; v < m.p.size() && cage.boundary == CAGE_BOUNDARY_EDGE_AND_CORNER; v++)
        if (n_faces[v] == 1)
            m.sharpness[v] = infinite;
    return m;
}

/* A face of a mesh with four corners, counted from corner `start`. */
struct turned_quad {
    int face;
    int start;
};

/* A level that is prepared for walking from face to face. */
struct level {
    mesh m;
    incidence incident;

    explicit level(const mesh &trimmed_mesh) : m(trimmed_mesh), incident(m)
    {
    }

    int vertex(turned_quad q, int corner) const
    {
        return m.faces[(size_t)q.face][(size_t)((q.start + corner) & 3)];
    }
    point at(turned_quad q, int corner) const
    {
        return m.p[(size_t)vertex(q, corner)];
    }
    /* The quad across edge `edge`, rotated so that its sides are parallel to q's; its face is
     * `nowhere` where the surface ends. Sets *semisharp if the edge's rule may still change. */
    turned_quad across(turned_quad q, int edge, bool *semisharp) const
    {
        int a = vertex(q, edge), b = vertex(q, edge + 1);
        const incidence::edge &e = incident.edges.at(key(a, b));
        *semisharp |= e.sharpness > 0 && e.sharpness < infinite;
        if (e.sharpness >= infinite)
            return {nowhere, 0};
        int other = e.faces[0] == q.face ? e.faces[1] : e.faces[0];
        const std::vector<int> &face = m.faces[(size_t)other];
        int from_b = (int)(std::find(face.begin(), face.end(), b) - face.begin());
        return {other, from_b - (edge + 2) + 8};
    }
};

/* Writes the 16 points around a quad. Returns whether they define a B-spline patch, that is,
 * whether all four corners are regular. */
bool find_net(const level &l, turned_quad q, point net[4][4])
{
    /* x and y of the four corners */
    static const int at[4][2] = {{1, 1}, {2, 1}, {2, 2}, {1, 2}};
    /* from the quad across edge k */
    static const int step[4][2] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}};
    bool semisharp = false;
    turned_quad beside[4];
    for (int k = 0; k < 4; k++)
        net[at[k][1]][at[k][0]] = l.at(q, k);
    auto node = [&](int x, int y) -> point & { return net[y][x]; };
    for (int k = 0; k < 4; k++) {
        beside[k] = l.across(q, k, &semisharp);
        int dx = step[k][0], dy = step[k][1];
        for (int end : {k, (k + 1) & 3}) {
            int x = at[end][0], y = at[end][1];
            node(x + dx, y + dy) = beside[k].face == nowhere
                                       ? 2.0L * node(x, y) - node(x - dx, y - dy)
                                       : l.at(beside[k], end);
        }
    }
    for (int k = 0; k < 4; k++) { /* diagonally beyond corner k, where edges k and k - 1 meet */
        int before = (k + 3) & 3, x = at[k][0], y = at[k][1];
        int dx = step[k][0] + step[before][0], dy = step[k][1] + step[before][1];
        turned_quad diagonal = {nowhere, 0};
        if (beside[k].face != nowhere)
            diagonal = l.across(beside[k], before, &semisharp);
        bool by_row = beside[k].face != nowhere || beside[before].face == nowhere;
        int rx = by_row ? step[before][0] : step[k][0], ry = by_row ? step[before][1] : step[k][1];
        point edge = node(x + dx - rx, y + dy - ry),
              behind = node(x + dx - 2 * rx, y + dy - 2 * ry);
        node(x + dx, y + dy) = diagonal.face == nowhere ? 2.0L * edge - behind : l.at(diagonal, k);
    }
    for (int k = 0; k < 4; k++) {
        int v = l.vertex(q, k);
        double s = l.m.sharpness[(size_t)v];
        int n_sharp = 0;
        for (int w : l.incident.vertex_ends[(size_t)v])
            n_sharp += l.incident.edges.at(key(v, w)).sharpness > 0;
        size_t n = l.incident.vertex_faces[(size_t)v].size();
        bool open = beside[k].face == nowhere || beside[(k + 3) & 3].face == nowhere;
        bool interior = n == 4 && n_sharp == 0, border = open && n_sharp == 2 && (n == 4 || n == 2);
        semisharp |= s > 0 || !(interior || border);
    }
    return !semisharp;
}

void cubic(long double t, long double b[3][4])
{
    long double s = 1 - t;
    const long double value[3][4] = {
        {s * s * s / 6, (3 * t * t * t - 6 * t * t + 4) / 6, (3 * s * s * s - 6 * s * s + 4) / 6,
         t * t * t / 6},
        {-s * s / 2, (3 * t * t - 4 * t) / 2, (4 * s - 3 * s * s) / 2, t * t / 2},
        {s, 3 * t - 2, 3 * s - 2, t}};
    for (int d = 0; d < 3; d++)
        std::copy_n(value[d], 4, b[d]);
}

local_sample evaluate_net(const point net[4][4], long double s, long double t, point origin)
{
    long double x[3][4], y[3][4];
    cubic(s, x);
    cubic(t, y);
    point d[3][3];
    for (int a = 0; a < 3; a++)
        for (int b = 0; a + b < 3; b++)
            for (int j = 0; j < 4; j++)
                for (int i = 0; i < 4; i++)
                    d[a][b] = d[a][b] + (x[a][i] * y[b][j]) * net[j][i];
    point du = d[1][0], dv = d[0][1], n = outer(du, dv);
    long double e = inner(du, du), f = inner(du, dv), g = inner(dv, dv), area = norm(n);
    n = (1 / area) * n;
    long double w = area * area, l = inner(d[2][0], n), m = inner(d[1][1], n),
                k = inner(d[0][2], n);
    long double mean = (e * k - 2 * f * m + g * l) / (2 * w), gauss = (l * k - m * m) / w;
    long double half = std::sqrt(std::max(mean * mean - gauss, 0.0L));
    return {rounded(origin + d[0][0]),
            rounded(n),
            {(double)(mean - half), (double)(mean + half)},
            (double)(area / std::sqrt(e * g))};
}

} // namespace

struct local_surface::implementation {
    std::vector<level> levels; /* levels[0] is level 1 */
    /* corners whose Ptex face is a face of level 1, because their cage face is an n-gon */
    std::set<uint32_t> of_ngon;
};

local_surface::local_surface(const cage &cage, uint32_t vertex, int levels) : m(new implementation)
{
    mesh at = trimmed(read_cage(cage, vertex));
    for (size_t f = 0; f < at.faces.size(); f++)
        if (at.faces[f].size() != 4)
            m->of_ngon.insert(at.corner[f]);
    for (int n = 0; n < levels; n++) {
        at = trimmed(refinement(at).fine);
        m->levels.emplace_back(at);
    }
}

local_surface::~local_surface() = default;

bool local_surface::evaluate(uint32_t corner, double a, double b, local_sample *out) const
{
    if (m->of_ngon.count(corner)) {
        a *= 0.5;
        b *= 0.5;
    }
    double most = std::fmax(a, b);
    if (!(most > 0 && most <= 1 && a >= 0 && b >= 0))
        return false;
    int exponent;
    std::frexp(most, &exponent);
    int n = std::max(1, 1 - exponent);
    if (n > (int)m->levels.size())
        return false;
    const level &l = m->levels[(size_t)n - 1];
    auto found = std::find(l.m.corner.begin(), l.m.corner.end(), corner);
    if (found == l.m.corner.end())
        return false;
    turned_quad q = {(int)(found - l.m.corner.begin()), 0};
    double s = std::ldexp(a, n), t = std::ldexp(b, n);
    bool right = s >= 1, upper = t >= 1, semisharp = false;
    if (right)
        q = l.across(q, 1, &semisharp);
    if (upper)
        q = l.across(q, 2, &semisharp);
    point net[4][4];
    if (q.face == nowhere || !find_net(l, q, net))
        return false;
    *out = evaluate_net(net, (long double)s - right, (long double)t - upper, l.m.origin);
    return true;
}
