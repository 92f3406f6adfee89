#include "server/render/mesh.h"

#include <math.h>
#include <stdlib.h>

#include "server/render/renderer.h"
#include "server/surface/evaluate.h"

/* Quads along an edge of a Ptex face. */
static uint32_t cells_of(const struct limit_node *root, uint32_t level)
{
    return !root->ngon_size ? 1u << level : level ? 1u << (level - 1) : 1u;
}

struct mesh_size {
    uint64_t vertices, quads;
};

static size_t mesh_bytes(uint64_t n_vertices, uint64_t n_indices)
{
    return (size_t)n_vertices * sizeof(struct mesh_vertex) + (size_t)n_indices * sizeof(uint32_t);
}

static struct mesh_size measure(const struct limit_tables *tables, uint32_t level)
{
    struct mesh_size size = {0, 0};
    for (size_t face = 0; face < tables->n_faces; face++) {
        const struct limit_node *root = &tables->nodes[face];
        if (root->kind == LIMIT_HOLE)
            continue;
        uint64_t cells = cells_of(root, level);
        size.vertices += (cells + 1) * (cells + 1);
        size.quads += cells * cells;
    }
    return size;
}

size_t renderer_polygon_bytes(const struct limit_tables *tables, uint32_t level)
{
    struct mesh_size size = measure(tables, level);
    if (size.vertices > MESH_MAX_VERTICES)
        return 0;
    return mesh_bytes(size.vertices, 6 * size.quads);
}

struct renderer_polygons *renderer_polygons_create(const struct limit_tables *tables,
                                                   uint32_t level, const struct frame_watch *watch,
                                                   struct error *error)
{
    struct renderer_polygons *polygons = malloc(sizeof *polygons);
    if (!polygons) {
        error_set(error, ERROR_SERVER, "out of memory for polygons");
        return NULL;
    }
    atomic_init(&polygons->holders, 1);
    if (mesh_init(&polygons->mesh, tables, level, watch, error))
        return polygons;
    free(polygons);
    return NULL;
}

void renderer_polygons_destroy(struct renderer_polygons *polygons)
{
    polygons_release(polygons);
}

void polygons_hold(struct renderer_polygons *polygons)
{
    atomic_fetch_add(&polygons->holders, 1);
}

void polygons_release(struct renderer_polygons *polygons)
{
    if (!polygons || atomic_fetch_sub(&polygons->holders, 1) > 1)
        return;
    mesh_finish(&polygons->mesh);
    free(polygons);
}

static bool refuse(const struct limit_tables *tables, uint32_t level, uint64_t quads,
                   struct error *error)
{
    uint32_t fits = level;
    while (fits > 0 && measure(tables, fits).vertices > MESH_MAX_VERTICES)
        fits--;
    if (measure(tables, fits).vertices > MESH_MAX_VERTICES)
        return error_set(error, ERROR_REQUEST,
                         "surface: the cage alone has %llu faces, more than polygons are made of: "
                         "choose --surface exact",
                         (unsigned long long)measure(tables, 0).quads);
    return error_set(error, ERROR_REQUEST,
                     "surface: level %u makes %llu polygons, more than fit (%llu vertices): choose "
                     "level %u or less",
                     level, (unsigned long long)quads, (unsigned long long)MESH_MAX_VERTICES, fits);
}

static void add_vertex(struct mesh *mesh, uint32_t face, uint32_t cells, uint32_t x, uint32_t y,
                       struct vec s, struct vec n)
{
    const double *c = mesh->centre;
    mesh->vertex[mesh->n_vertices++] = (struct mesh_vertex){
        .position = {(float)(s.x - c[0]), (float)(s.y - c[1]), (float)(s.z - c[2])},
        .normal = {(float)n.x, (float)n.y, (float)n.z},
        .face = face,
        .x = (uint8_t)x,
        .y = (uint8_t)y,
        .cells = (uint8_t)cells,
    };
}

/* Returns a new part, unless the last one of the chunk has room. */
static struct mesh_part *part_for(struct mesh *mesh, uint32_t n)
{
    uint32_t chunk = (uint32_t)mesh->n_chunks - 1;
    struct mesh_part *last = mesh->n_parts ? &mesh->part[mesh->n_parts - 1] : NULL;
    if (last && last->chunk == chunk && last->n + n <= MESH_PART_INDICES)
        return last;
    struct mesh_part *part = &mesh->part[mesh->n_parts++];
    *part = (struct mesh_part){.first = (uint32_t)mesh->n_indices, .chunk = chunk};
    for (int k = 0; k < 3; k++) {
        part->box_min[k] = INFINITY;
        part->box_max[k] = -INFINITY;
    }
    return part;
}

/* A block: a part of a face's grid, in cells and vertices. */
struct block {
    uint32_t x, y, end_x, end_y;
};

static void add_block(struct mesh *mesh, uint32_t first, uint32_t row, const struct block *block)
{
    uint32_t n = 6 * (block->end_x - block->x) * (block->end_y - block->y);
    struct mesh_part *part = part_for(mesh, n);
    part->n += n;
    for (uint32_t y = block->y; y < block->end_y; y++)
        for (uint32_t x = block->x; x < block->end_x; x++) {
            uint32_t a = first + y * row + x, b = a + 1, c = b + row, d = a + row;
            const uint32_t corners[6] = {a, b, c, a, c, d};
            for (int i = 0; i < 6; i++)
                mesh->index[mesh->n_indices++] = corners[i];
        }
    for (uint32_t y = block->y; y <= block->end_y; y++)
        for (uint32_t x = block->x; x <= block->end_x; x++) {
            const float *p = mesh->vertex[first + y * row + x].position;
            for (int k = 0; k < 3; k++) {
                part->box_min[k] = fminf(part->box_min[k], p[k]);
                part->box_max[k] = fmaxf(part->box_max[k], p[k]);
            }
        }
}

/* Chooses the chunk of the next face: a new one if the last is full. */
static void choose_chunk(struct mesh *mesh)
{
    const struct mesh_chunk *last = mesh->n_chunks ? &mesh->chunk[mesh->n_chunks - 1] : NULL;
    if (last && mesh_bytes(last->n_vertices, last->n_indices) < MESH_CHUNK_BYTES)
        return;
    mesh->chunk[mesh->n_chunks++] = (struct mesh_chunk){
        .first_vertex = (uint32_t)mesh->n_vertices,
        .first_index = (uint32_t)mesh->n_indices,
    };
}

/* Adds the two triangles of every cell of the grid whose vertices were added last. */
static void add_cells(struct mesh *mesh, uint32_t cells)
{
    enum { BLOCK = 32 };
    uint32_t row = cells + 1, first = (uint32_t)mesh->n_vertices - row * row;
    for (uint32_t y = 0; y < cells; y += BLOCK)
        for (uint32_t x = 0; x < cells; x += BLOCK) {
            const struct block block = {x, y, x + BLOCK < cells ? x + BLOCK : cells,
                                        y + BLOCK < cells ? y + BLOCK : cells};
            add_block(mesh, first, row, &block);
        }
    struct mesh_chunk *chunk = &mesh->chunk[mesh->n_chunks - 1];
    chunk->n_vertices = (uint32_t)mesh->n_vertices - chunk->first_vertex;
    chunk->n_indices = (uint32_t)mesh->n_indices - chunk->first_index;
}

static void add_face(struct mesh *mesh, const struct limit_tables *tables, uint32_t face,
                     uint32_t cells)
{
    for (uint32_t y = 0; y <= cells; y++)
        for (uint32_t x = 0; x <= cells; x++) {
            struct limit_point p = {0};
            limit_evaluate(tables, face, (double)x / cells, (double)y / cells, &p);
            add_vertex(mesh, face, cells, x, y, p.s, p.n);
        }
    add_cells(mesh, cells);
}

static struct limit_point corner_of(const struct limit_tables *tables, uint32_t face)
{
    struct limit_point p = {0};
    limit_evaluate(tables, face, 0, 0, &p);
    return p;
}

static struct vec halfway(struct vec a, struct vec b)
{
    return vec_scale(vec_add(a, b), 0.5);
}

/* Adds a whole n-gon at level 0; `first` is the Ptex face at its corner 0. Between two corners and
 * the middle everything is linear, so the halves of a triangle lie in its plane. */
static void add_fan(struct mesh *mesh, const struct limit_tables *tables, uint32_t first,
                    uint32_t n)
{
    struct vec s = {0, 0, 0}, normal = {0, 0, 0};
    for (uint32_t k = 0; k < n; k++) {
        struct limit_point p = corner_of(tables, first + k);
        s = vec_mad(s, 1.0 / n, p.s);
        normal = vec_mad(normal, 1.0 / n, p.n);
    }
    struct limit_point before = corner_of(tables, first + n - 1), own = corner_of(tables, first);
    for (uint32_t k = 0; k < n; k++) {
        struct limit_point after = corner_of(tables, first + (k + 1) % n);
        uint32_t face = (first + k) | MESH_IS_FAN;
        add_vertex(mesh, face, 1, 0, 0, own.s, own.n);
        add_vertex(mesh, face, 1, 1, 0, halfway(own.s, after.s), halfway(own.n, after.n));
        add_vertex(mesh, face, 1, 0, 1, halfway(before.s, own.s), halfway(before.n, own.n));
        add_vertex(mesh, face, 1, 1, 1, s, normal);
        add_cells(mesh, 1);
        before = own;
        own = after;
    }
}

static bool reserve(struct mesh *mesh, const struct mesh_size *size)
{
    size_t most_chunks = mesh_bytes(size->vertices, 6 * size->quads) / MESH_CHUNK_BYTES + 1;
    /* Any two consecutive parts have more indices together than one part may have. */
    size_t most_parts = 2 * (size_t)(6 * size->quads / MESH_PART_INDICES) + 2 * most_chunks;
    mesh->vertex = malloc((size->vertices + 1) * sizeof *mesh->vertex);
    mesh->index = malloc((6 * size->quads + 1) * sizeof *mesh->index);
    mesh->part = malloc(most_parts * sizeof *mesh->part);
    mesh->chunk = malloc(most_chunks * sizeof *mesh->chunk);
    return mesh->vertex && mesh->index && mesh->part && mesh->chunk;
}

bool mesh_init(struct mesh *mesh, const struct limit_tables *tables, uint32_t level,
               const struct frame_watch *watch, struct error *error)
{
    *mesh = (struct mesh){0};
    struct mesh_size size = measure(tables, level);
    if (size.vertices > MESH_MAX_VERTICES)
        return refuse(tables, level, size.quads, error);
    if (!reserve(mesh, &size)) {
        mesh_finish(mesh);
        return error_set(error, ERROR_SERVER, "out of memory for %llu polygons",
                         (unsigned long long)size.quads);
    }
    for (int k = 0; k < 3; k++)
        mesh->centre[k] = 0.5 * (tables->box_min[k] + tables->box_max[k]);
    for (uint32_t face = 0; face < tables->n_faces; face++) {
        const struct limit_node *root = &tables->nodes[face];
        if (root->kind == LIMIT_HOLE)
            continue;
        if (!frame_watch_check(watch, error)) {
            mesh_finish(mesh);
            return false;
        }
        choose_chunk(mesh);
        if (level > 0 || !root->ngon_size)
            add_face(mesh, tables, face, cells_of(root, level));
        else if (root->ngon_corner == 0)
            add_fan(mesh, tables, face, root->ngon_size);
    }
    return true;
}

void mesh_finish(struct mesh *mesh)
{
    free(mesh->vertex);
    free(mesh->index);
    free(mesh->part);
    free(mesh->chunk);
    *mesh = (struct mesh){0};
}

bool mesh_part_is_outside(const struct mesh_part *part, const double centre[3],
                          const struct view *view, const struct view_sides *sides)
{
    double world[3], camera[3], radius = 0;
    for (int k = 0; k < 3; k++) {
        double low = (double)part->box_min[k], high = (double)part->box_max[k];
        world[k] = centre[k] + 0.5 * (low + high);
        radius = hypot(radius, 0.5 * (high - low));
    }
    view_transform(view, world, camera);
    double px = view->units_per_px * (view->perspective ? fabs(camera[2]) + radius : 1);
    /* The rounding error of single precision in positions relative to the mesh's centre and to the
     * eye. */
    double rounding = 1e-6 * radius;
    for (int k = 0; k < 3; k++)
        rounding += 1e-6 * (fabs(camera[k]) + fabs(centre[k] - view->eye[k]));
    return view_sides_exclude(sides, camera, radius + px + rounding);
}
