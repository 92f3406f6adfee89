// Walks across edges of nodes and Ptex faces, so that the solution for a pixel may lie in another node than its first
// guess.
//
// A place is given from corner k of a Ptex face: `ab.x` along edge k (towards corner k + 1), `ab.y` along edge k - 1
// backwards. Near an extraordinary vertex these coordinates keep full relative precision; (u,v) of the whole face
// would not.

struct Place {
    uint face;
    uint corner;
    vec2 ab;
};

// Converts coordinates given from corner k to those given from corner 0, and back.
vec2 unturned(vec2 ab, uint k)
{
    return k == 0u ? ab : k == 1u ? vec2(1.0 - ab.y, ab.x) : k == 2u ? 1.0 - ab
                                                                     : vec2(ab.y, 1.0 - ab.x);
}

vec2 turned(vec2 uv, uint k)
{
    return k == 0u ? uv : k == 1u ? vec2(uv.y, 1.0 - uv.x) : k == 2u ? 1.0 - uv
                                                                     : vec2(1.0 - uv.y, uv.x);
}

// A node's local coordinates as (u,v) of its Ptex face.
vec2 ptex_uv(Node node, vec2 xy)
{
    return (vec2(node.cell) + unturned(xy, node.rotation)) * ldexp(1.0, -int(node.depth));
}

Place place_of(Node node, vec2 xy)
{
    float size = ldexp(1.0, -int(node.depth));
    if (node.kind == CORNER && max(xy.x, xy.y) < 0.5)  // its vertex is a corner of the Ptex face
        return Place(node.face, node.rotation, xy * size);
    vec2 uv = ptex_uv(node, xy);
    uint k = uv.x < 0.5 ? (uv.y < 0.5 ? 0u : 3u) : (uv.y < 0.5 ? 1u : 2u);
    return Place(node.face, k, turned(uv, k));
}

// Moves a place across `edge` of its face; it stays relative to the same vertex, which is the edge's first one if
// `at_start`. `along` is the distance from that vertex, `outside` how far beyond the edge the place lies. False at a
// boundary.
bool across_edge(inout Place place, uint edge, bool at_start, float along, float outside)
{
    uint other = adjacency_of(place.face)[edge];
    if (other == NONE)
        return false;
    Node from = node_load(place.face);
    uint face = other >> 2, e = other & 3u;
    Node to = node_load(face);
    bool from_half = from.ngon_size != 0u && (edge == 0u || edge == 3u);
    bool to_half = to.ngon_size != 0u && (e == 0u || e == 3u);
    float unit = 1.0;
    if (from_half && !to_half) {
        unit = 0.5;
        // The vertex in the middle of the other face's edge is not one of its corners.
        if (at_start == (edge == 3u))
            along = 1.0 - along;
    } else if (!from_half && to_half) {
        unit = 2.0;
        if (at_start) {  // the next Ptex face of the n-gon is there
            uint next = to.ngon_corner + 1u;
            face = face - to.ngon_corner + (next == to.ngon_size ? 0u : next);
            e = 3u;
        }
    }
    place.face = face;
    // The two faces run along a shared edge in opposite directions. Where halves of an edge meet, the shared vertex
    // is the cage's.
    bool to_end = from_half != to_half ? (from_half ? edge == 0u : e == 3u) : at_start;
    place.corner = to_end ? (e + 1u) & 3u : e;
    place.ab = to_end ? vec2(outside, along) * unit : vec2(along, outside) * unit;
    return true;
}

// Brings a place with a negative coordinate back inside a face, across one edge or two. At a boundary the coordinate
// becomes 0: the nearest place on the surface.
void settle(inout Place place)
{
    for (int i = 0; i < 3 && min(place.ab.x, place.ab.y) < 0.0; i++) {
        uint k = place.corner;
        vec2 ab = place.ab;
        bool over_first = ab.y < 0.0;  // edge k, which starts at corner k
        bool crossed = over_first ? across_edge(place, k, true, ab.x, -ab.y)
                                  : across_edge(place, (k + 3u) & 3u, false, ab.y, -ab.x);
        if (!crossed) {
            place.ab = over_first ? vec2(ab.x, 0.0) : vec2(0.0, ab.y);
        }
    }
    place.ab = clamp(place.ab, 0.0, 1.0);
}

// The node at a settled place, and the local coordinates there. HOLE nodes are found too.
uint node_under(Place place, out Node node, out vec2 xy)
{
    uint i = place.face;
    vec2 ab = place.ab;
    node = node_load(i);
    while (node.kind == SPLIT) {
        bvec2 far = greaterThanEqual(ab, vec2(0.5));
        ab = 2.0 * ab - vec2(far);
        uint turn = far.y ? (far.x ? 2u : 3u) : (far.x ? 1u : 0u);
        i = node.first + ((place.corner + turn) & 3u);
        node = node_load(i);
    }
    xy = node.rotation == place.corner ? ab : turned(unturned(ab, place.corner), node.rotation);
    return i;
}
