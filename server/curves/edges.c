#include "server/curves/edges.h"

#include <stdlib.h>
#include <string.h>

static bool is_hole(const struct limit_tables *tables, uint32_t face)
{
    return tables->nodes[face].kind == LIMIT_HOLE;
}

/* What the tables say about edge e of a face: 0, LIMIT_BORDER_SHARP or the levels of a crease. */
static unsigned border_at(const struct limit_tables *tables, uint32_t face, unsigned edge)
{
    return tables->nodes[face].borders >> (4 * edge) & 15;
}

/* True if normals agree across edge e of a face, but curvatures do not. */
static bool is_bend(const struct limit_tables *tables, uint32_t face, unsigned edge)
{
    return tables->bends && tables->bends[face] >> edge & 1;
}

/* True for an edge that is one point, such as a pole: a border of nothing. */
static bool is_collapsed(const struct limit_tables *tables, uint32_t face, unsigned edge)
{
    return tables->adjacency[face].across[edge] == LIMIT_NO_FACE &&
           border_at(tables, face, edge) == 0;
}

static bool is_part_of_ngon(const struct limit_tables *tables, uint32_t face)
{
    return tables->nodes[face].ngon_size > 0;
}

static uint32_t across(const struct limit_tables *tables, uint32_t face, unsigned edge)
{
    return tables->adjacency[face].across[edge];
}

/* True for the middle of an edge of an n-gon, where there is no vertex of the cage. */
static bool is_middle(const struct limit_tables *tables, uint32_t face, unsigned corner)
{
    return is_part_of_ngon(tables, face) && (corner & 1);
}

bool surface_next_around(const struct limit_tables *tables, uint32_t *face, unsigned *corner)
{
    uint32_t next = across(tables, *face, (*corner + 3) & 3);
    if (next == LIMIT_NO_FACE)
        return false;
    *face = next >> 2;
    *corner = next & 3;
    return true;
}

/* --- edges */

static void list_edge(struct surface_edges *edges, const struct limit_tables *tables, uint32_t face,
                      unsigned edge)
{
    const unsigned levels = border_at(tables, face, edge);
    const uint32_t other = across(tables, face, edge);
    const bool bends = is_bend(tables, face, edge);
    if (is_collapsed(tables, face, edge))
        return;
    if (other == LIMIT_NO_FACE || is_hole(tables, other >> 2)) {
        edges->borders[edges->n_borders++] = (struct surface_border){face, (uint8_t)edge};
        return;
    }
    bool is_part = is_part_of_ngon(tables, face), beside_part = is_part_of_ngon(tables, other >> 2);
    bool is_listed_there = is_part == beside_part ? (face << 2 | edge) > other : beside_part;
    if ((levels == 0 && !bends) || is_listed_there)
        return;
    struct surface_edge crease = {.face = {face, other >> 2},
                                  .edge = {(uint8_t)edge, other & 3},
                                  .levels = (uint8_t)(bends ? LIMIT_BORDER_SHARP : levels),
                                  .is_bend = bends,
                                  .from = 1,
                                  .by = -1};
    if (is_part && !beside_part) {
        crease.by = -0.5;
        crease.from = edge == 0 ? 1 : 0.5;
    }
    edges->creases[edges->n_creases++] = crease;
}

static void list_edges(struct surface_edges *edges, const struct limit_tables *tables)
{
    for (uint32_t face = 0; face < tables->n_faces; face++)
        for (unsigned edge = 0; edge < 4 && !is_hole(tables, face); edge++)
            list_edge(edges, tables, face, edge);
}

/* --- sectors */

/* True if the surface around the corner is that of an extraordinary vertex there. */
static bool is_extraordinary(const struct limit_tables *tables, uint32_t face, unsigned corner)
{
    const struct limit_node *node = &tables->nodes[face];
    while (node->kind == LIMIT_SPLIT)
        node = &tables->nodes[node->first + corner];
    return node->kind == LIMIT_CORNER && node->rotation == corner;
}

/* One bit for each corner of each face. */
static bool take_bit(uint8_t *bits, uint32_t face, unsigned corner)
{
    uint8_t *byte = &bits[face / 2], bit = (uint8_t)(1u << (4 * (face & 1) + corner));
    bool was = *byte & bit;
    *byte |= bit;
    return was;
}

static bool has_bit(const uint8_t *bits, uint32_t face, unsigned corner)
{
    return bits[face / 2] >> (4 * (face & 1) + corner) & 1;
}

/* Walks around a vertex from a corner of a face, marks the corners as seen, and lists the sector. Where the walk ends
 * at the crease at which it began, that crease ends at the vertex: `darts` gets its edge, from either side. */
static void walk_sector(struct surface_edges *edges, const struct limit_tables *tables,
                        uint32_t first, unsigned first_corner, uint8_t *seen, uint8_t *darts)
{
    struct surface_sector sector = {first, (uint8_t)first_corner, false, 0};
    const bool from_crease = border_at(tables, first, first_corner) == LIMIT_BORDER_SHARP;
    uint32_t face = first;
    unsigned corner = first_corner;
    bool more = true;
    while (more && !take_bit(seen, face, corner)) {
        sector.n_faces++;
        const unsigned last_edge = (corner + 3) & 3;
        const uint32_t last = face;
        bool is_sharp = border_at(tables, face, last_edge) == LIMIT_BORDER_SHARP;
        more = surface_next_around(tables, &face, &corner);
        bool is_round = more && face == first && corner == first_corner;
        if (is_round && is_sharp && from_crease) {
            take_bit(darts, first, first_corner);
            take_bit(darts, last, last_edge);
        }
        sector.is_closed = is_round;
        more = more && !is_sharp && !is_round;
    }
    if (is_extraordinary(tables, first, first_corner))
        edges->sectors[edges->n_sectors++] = sector;
}

static void list_sectors(struct surface_edges *edges, const struct limit_tables *tables,
                         uint8_t *seen, uint8_t *darts)
{
    for (int round = 0; round < 2;
         round++) /* first from creases and borders, then what is closed */
        for (uint32_t face = 0; face < tables->n_faces; face++)
            for (unsigned corner = 0; corner < 4; corner++) {
                bool starts = round == 1 || border_at(tables, face, corner) == LIMIT_BORDER_SHARP;
                if (starts && !has_bit(seen, face, corner) && !is_middle(tables, face, corner))
                    walk_sector(edges, tables, face, corner, seen, darts);
            }
    for (size_t i = 0; i < edges->n_creases; i++) {
        struct surface_edge *crease = &edges->creases[i];
        crease->has_dart = has_bit(darts, crease->face[0], crease->edge[0]) ||
                           has_bit(darts, crease->face[1], crease->edge[1]);
    }
}

/* --- all */

struct surface_edges_room surface_edges_room(const struct limit_tables *tables)
{
    struct surface_edges_room room = {0, 0, 0, 2 * (tables->n_faces / 2 + 1)};
    for (uint32_t face = 0; face < tables->n_faces; face++)
        for (unsigned edge = 0; edge < 4; edge++) {
            const uint32_t other = across(tables, face, edge);
            bool ends = other == LIMIT_NO_FACE || is_hole(tables, other >> 2);
            room.borders += ends;
            room.creases +=
                !ends && (border_at(tables, face, edge) > 0 || is_bend(tables, face, edge));
            room.sectors += is_extraordinary(tables, face, edge);
        }
    room.bytes += (room.creases + 1) * sizeof(struct surface_edge) +
                  (room.borders + 1) * sizeof(struct surface_border) +
                  (room.sectors + 1) * sizeof(struct surface_sector);
    return room;
}

bool surface_edges_list(struct surface_edges *edges, const struct limit_tables *tables,
                        struct error *error)
{
    const struct surface_edges_room room = surface_edges_room(tables);
    const size_t bits = tables->n_faces / 2 + 1;
    uint8_t *seen = calloc(2, bits); /* and the darts behind them */
    *edges = (struct surface_edges){.n_creases = 0};
    edges->creases = malloc((room.creases + 1) * sizeof *edges->creases);
    edges->borders = malloc((room.borders + 1) * sizeof *edges->borders);
    edges->sectors = malloc((room.sectors + 1) * sizeof *edges->sectors);
    bool ok = seen && edges->creases && edges->borders && edges->sectors;
    if (ok) {
        list_edges(edges, tables);
        list_sectors(edges, tables, seen, seen + bits);
    } else {
        surface_edges_finish(edges);
        error_set(error, ERROR_SERVER, "no memory for the edges of %zu faces: try again later",
                  tables->n_faces);
    }
    free(seen);
    return ok;
}

void surface_edges_finish(struct surface_edges *edges)
{
    free(edges->creases);
    free(edges->borders);
    free(edges->sectors);
    *edges = (struct surface_edges){.n_creases = 0};
}
