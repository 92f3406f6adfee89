/* Places on nodes: which sub-patch holds one, and where steps across a node's borders lead. The same as
 * shaders/neighbours.glsl and surface.glsl, in double precision. */
#include "server/render/native/tile.h"

#include <assert.h>
#include <math.h>

static_assert(TILE_PATCHES == 256, "eight bits of a key's hash");

/* A share of what remains of a CORNER, about 8 steps of native_tile_room.place. */
static const double NEAR_VERTEX = 1.0 / 8000;

/* For numbers, never NaN; the functions of math.h are calls. */
static inline double least(double a, double b)
{
    return a < b ? a : b;
}

static inline double largest(double a, double b)
{
    return a > b ? a : b;
}

/* The level from 1 on whose squares reach from 2^-level to 2^(1 - level). */
static inline int level_of(double nearest)
{
    uint64_t bits;
    memcpy(&bits, &nearest, sizeof bits);
    return 1023 - (int)(bits >> 52 & 2047);
}

static int levels_of(const struct limit_node *node)
{
    return node->levels & ~(int)LIMIT_NO_NORMAL;
}

const struct native_patch *native_patch_of(const struct native_frame *frame,
                                           struct native_tile_room *room, uint32_t node,
                                           uint32_t index)
{
    uint64_t key = record_cache_key(node, index);
    struct native_found_patch *found = &room->patch[key * 0x9e3779b97f4a7c15u >> 56];
    const struct native_patch *kept = native_patch_find(frame->model, node, index);
    if (kept)
        return kept;
    if (found->node != node || found->index != index) {
        kept = native_patch_get(frame->model, node, index, &found->patch);
        found->node = node;
        found->index = index;
    }
    return kept ? kept : &found->patch;
}

const struct native_patch *native_patch_of_piece(const struct native_frame *frame,
                                                 struct native_tile_room *room,
                                                 struct native_piece *piece)
{
    const struct native_patch *patch = native_piece_patch(piece);
    if (patch)
        return patch;
    uint32_t index = native_piece_index(&frame->model->tables->nodes[piece->node], piece);
    patch = native_patch_find(frame->model, piece->node, index);
    if (patch) /* every thread finds the same */
        __atomic_store_n(&piece->patch, patch, __ATOMIC_RELEASE);
    return patch ? patch : native_patch_of(frame, room, piece->node, index);
}

struct native_part_of_node native_patch_at(const struct limit_node *node, double x, double y)
{
    struct native_part_of_node part = {0};
    bool is_corner = node->kind == LIMIT_CORNER;
    if (!is_corner && node->kind != LIMIT_STRIP)
        return part;
    double nearest = is_corner ? largest(x, y) : y;
    int levels = levels_of(node);
    int level = nearest > 0 ? level_of(nearest) : levels + 1;
    level = level < 1 ? 1 : level;
    if (!is_corner) {
        /* The last patch begins at the crease and is as wide as the patch before it. */
        bool is_last = level > levels;
        level = is_last ? levels + 1 : level;
        part.scale_y = (int8_t)(level - is_last);
        part.origin_y = !is_last;
        part.index = (uint32_t)level - 1;
        return part;
    }
    part.at_vertex = level > levels;
    level = part.at_vertex ? levels : level;
    part.scale_x = part.scale_y = (int8_t)level;
    part.origin_x = x * native_power(level) >= 1;
    part.origin_y = y * native_power(level) >= 1;
    part.index = native_patch_index(node, level, part.origin_y ? 2 + !part.origin_x : 1);
    return part;
}

void native_place(const struct limit_tables *tables, const struct native_piece *piece, double s,
                  double t, double *x, double *y)
{
    const struct limit_node *node = &tables->nodes[piece->node];
    int scale_x = node->kind == LIMIT_CORNER ? piece->level : 0;
    int scale_y = node->kind == LIMIT_REGULAR ? 0 : piece->level;
    if (piece->kind == PIECE_OF_PATCH) {
        s = (double)piece->s + s * (double)piece->size + (piece->square == 1 || piece->square == 2);
        t = (double)piece->t + t * (double)piece->size + (piece->square >= 2);
    }
    *x = least(largest(s * native_power(-scale_x), 0), 1);
    *y = least(largest(t * native_power(-scale_y), 0), 1);
}

/* A patch is read only some time after its number is known. */
static void prefetch(const struct native_patch *patch)
{
    for (int line = 0; line < 4; line++)
        __builtin_prefetch((const char *)patch + 64 * line);
}

uint32_t native_guess_of(const struct native_part_of_node *part, const struct limit_node *node,
                         double x, double y)
{
    const double steps = 8191.0 / 2;
    int level = node->kind == LIMIT_REGULAR ? 0 : part->scale_y;
    double s = least(largest(x * native_power(part->scale_x), 0), 2);
    double t = least(largest(y * native_power(part->scale_y), 0), 2);
    return (uint32_t)level | (uint32_t)(s * steps + 0.5) << 6 | (uint32_t)(t * steps + 0.5) << 19;
}

void native_begin_at(const struct native_model *model, struct native_task *task, double x, double y)
{
    struct native_part_of_node *part = &task->part;
    *part = native_patch_at(&model->tables->nodes[task->node], x, y);
    task->s = (float)(x * native_power(part->scale_x) - part->origin_x);
    task->t = (float)(y * native_power(part->scale_y) - part->origin_y);
    task->patch = native_patch_find(model, task->node, part->index);
    if (task->patch)
        prefetch(task->patch);
}

void native_begin_on(const struct native_model *model, struct native_task *task,
                     const struct native_piece *piece, int32_t place)
{
    const struct limit_node *node = &model->tables->nodes[piece->node];
    double s = ((uint32_t)place & 0xffff) / 65535.0, t = ((uint32_t)place >> 16) / 65535.0, x, y;
    task->node = piece->node;
    if (piece->kind != PIECE_OF_PATCH) {
        /* Here begins what a rounded place cannot tell from the vertex: no step leads to it. */
        if (piece->kind == PIECE_REST && largest(s, t) < NEAR_VERTEX)
            s = t = 0;
        native_place(model->tables, piece, s, t, &x, &y);
        native_begin_at(model, task, x, y);
        return;
    }
    task->part = (struct native_part_of_node){
        .index = native_piece_index(node, piece),
        .scale_x = (int8_t)(node->kind == LIMIT_CORNER ? piece->level : 0),
        .scale_y = (int8_t)(node->kind == LIMIT_REGULAR ? 0 : piece->level),
        .origin_x = piece->square == 1 || piece->square == 2,
        .origin_y = piece->square >= 2};
    task->s = piece->s + (float)s * piece->size;
    task->t = piece->t + (float)t * piece->size;
    task->patch = native_piece_patch(piece);
    if (task->patch)
        prefetch(task->patch);
}

/* A place relative to a Ptex face's corner: a along the edge that begins there, b backwards along the edge that ends
 * there. Near an extraordinary vertex these keep their digits. */
struct face_place {
    uint32_t face;
    unsigned corner;
    double a, b;
};

/* Converts coordinates given from corner k to those given from corner 0, and back. */
static void unturn(double a, double b, unsigned k, double uv[2])
{
    const double us[4] = {a, 1 - b, 1 - a, b}, vs[4] = {b, a, 1 - b, 1 - a};
    uv[0] = us[k];
    uv[1] = vs[k];
}

static void turn(double u, double v, unsigned k, double ab[2])
{
    const double as[4] = {u, v, 1 - u, 1 - v}, bs[4] = {v, 1 - u, 1 - v, u};
    ab[0] = as[k];
    ab[1] = bs[k];
}

static void ptex_of(const struct limit_node *node, double x, double y, double uv[2])
{
    unturn(x, y, node->rotation, uv);
    uv[0] = ((node->cell & 0xffff) + uv[0]) * native_power(-node->depth);
    uv[1] = ((node->cell >> 16) + uv[1]) * native_power(-node->depth);
}

void native_ptex(const struct limit_node *node, double x, double y, float uv[2])
{
    double exact[2];
    ptex_of(node, x, y, exact);
    uv[0] = (float)exact[0];
    uv[1] = (float)exact[1];
}

static struct face_place place_of(const struct limit_node *node, double x, double y)
{
    double uv[2], ab[2];
    if (node->kind == LIMIT_CORNER && largest(x, y) < 0.5) /* its vertex is a corner of the face */
        return (struct face_place){node->face, node->rotation, x * native_power(-node->depth),
                                   y * native_power(-node->depth)};
    ptex_of(node, x, y, uv);
    unsigned k = uv[0] < 0.5 ? (uv[1] < 0.5 ? 0 : 3) : uv[1] < 0.5 ? 1 : 2;
    turn(uv[0], uv[1], k, ab);
    return (struct face_place){node->face, k, ab[0], ab[1]};
}

/* Moves a place across `edge` of its face; its vertex stays the same: the edge's first if at_start. `along` is the
 * distance from it, `outside` how far beyond the edge the place lies. False at a boundary. */
static bool cross_edge(const struct limit_tables *tables, struct face_place *place, unsigned edge,
                       bool at_start, double along, double outside)
{
    uint32_t other = tables->adjacency[place->face].across[edge];
    if (other == LIMIT_NO_FACE)
        return false;
    const struct limit_node *from = &tables->nodes[place->face], *to = &tables->nodes[other >> 2];
    uint32_t face = other >> 2;
    unsigned e = other & 3;
    bool from_half = from->ngon_size && (edge == 0 || edge == 3);
    bool to_half = to->ngon_size && (e == 0 || e == 3);
    double unit = 1;
    if (from_half && !to_half) {
        unit = 0.5;
        if (at_start ==
            (edge == 3)) /* the vertex in the middle of the other face's edge is not its corner */
            along = 1 - along;
    } else if (!from_half && to_half) {
        unit = 2;
        if (at_start) { /* the next Ptex face of the n-gon is there */
            uint32_t next = to->ngon_corner + 1u;
            face = face - to->ngon_corner + (next == to->ngon_size ? 0 : next);
            e = 3;
        }
    }
    /* The faces run along an edge in opposite directions. Where halves meet, the shared vertex is the cage's. */
    bool to_end = from_half != to_half ? (from_half ? edge == 0 : e == 3) : at_start;
    *place = (struct face_place){face, to_end ? (e + 1) & 3 : e, (to_end ? outside : along) * unit,
                                 (to_end ? along : outside) * unit};
    return true;
}

static double within(double a)
{
    return least(largest(a, 0), 1);
}

/* Brings a place with a negative coordinate back inside a face, across one edge or two. At a boundary the coordinate
 * becomes 0: the nearest place on the surface. */
static void settle(const struct limit_tables *tables, struct face_place *place)
{
    for (int i = 0; i < 3 && least(place->a, place->b) < 0; i++) {
        unsigned k = place->corner;
        double a = place->a, b = place->b;
        bool over_first = b < 0; /* edge k, which starts at corner k */
        bool crossed = over_first ? cross_edge(tables, place, k, true, a, -b)
                                  : cross_edge(tables, place, (k + 3) & 3, false, b, -a);
        if (!crossed && over_first)
            place->b = 0;
        else if (!crossed)
            place->a = 0;
    }
    place->a = within(place->a);
    place->b = within(place->b);
}

bool native_walk(const struct limit_tables *tables, uint32_t *node, double *x, double *y)
{
    if (*x >= 0 && *y >= 0 && *x <= 1 && *y <= 1)
        return true;
    if (!(fabs(*x) < 1e6 && fabs(*y) < 1e6)) /* no number, or nowhere near */
        return false;
    struct face_place place = place_of(&tables->nodes[*node], *x, *y);
    settle(tables, &place);
    uint32_t i = place.face;
    double a = place.a, b = place.b, uv[2], xy[2];
    while (tables->nodes[i].kind == LIMIT_SPLIT) {
        bool far_a = a >= 0.5, far_b = b >= 0.5;
        unsigned child = far_b ? (far_a ? 2 : 3) : far_a;
        a = 2 * a - far_a;
        b = 2 * b - far_b;
        i = tables->nodes[i].first + ((place.corner + child) & 3);
    }
    const struct limit_node *to = &tables->nodes[i];
    unturn(a, b, place.corner, uv);
    turn(uv[0], uv[1], to->rotation, xy);
    *node = i;
    *x = to->rotation == place.corner ? a : xy[0];
    *y = to->rotation == place.corner ? b : xy[1];
    return to->kind != LIMIT_HOLE;
}
