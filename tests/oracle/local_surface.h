/* The limit surface near one vertex of a cage, by repeated refinement of its neighbourhood in long
 * double: the textbook's rules (Catmull and Clark 1978; DeRose, Kass and Truong 1998) on a mesh of
 * three rings, as deep as requested, and a bicubic B-spline where the mesh is regular. Uses no
 * closed form for the vertex, and shares nothing with server/surface. */
#ifndef SHEEN_TESTS_ORACLE_LOCAL_SURFACE_H
#define SHEEN_TESTS_ORACLE_LOCAL_SURFACE_H

#include <cstdint>
#include <memory>

#include "tests/oracle/tables.h"
#include "tests/oracle/vec.h"

extern "C" {
#include "server/cage/cage.h"
}

struct local_sample {
    vec3 p;      /* rounded once */
    vec3 normal; /* unit */
    curvatures k;
    double spread; /* |du x dv| / (|du| |dv|): 0 where the derivatives span no plane */
};

class local_surface
{
  public:
    /* Levels 1 to `levels` of `vertex`. Throws std::runtime_error on cages with Chaikin creases,
     * smooth triangles, boundary mode NONE, or edges of three and more faces near the vertex. */
    local_surface(const cage &cage, uint32_t vertex, int levels);
    ~local_surface();
    local_surface(const local_surface &) = delete;
    local_surface &operator=(const local_surface &) = delete;

    /* Evaluates at (a, b) seen from cage corner `corner`, which must be at this vertex; each such
     * corner is a Ptex face. False at the vertex itself, beyond the last level, outside of [0,1],
     * and where the rules are not constant yet at the level in question, because of finite
     * sharpness or another extraordinary vertex nearby. */
    bool evaluate(uint32_t corner, double a, double b, local_sample *out) const;

  private:
    struct implementation;
    std::unique_ptr<implementation> m;
};

#endif
