/* Finds where the lines of a surface break: along infinitely sharp creases, and along borders that lie together (two
 * faces of a non-manifold edge, or parts of a model whose vertices were not joined). Measures how much, at the worst
 * place of each edge. README.md has the formulas, and says what is not a break.
 *
 * The computation is made by breaks_create() and runs as computation.h says. Then breaks_result() has its result. */
#ifndef SHEEN_CURVES_BREAKS_BREAKS_H
#define SHEEN_CURVES_BREAKS_BREAKS_H

#include "protocol/break_records.h"
#include "server/curves/breaks/break_limits.h"
#include "server/scene/scene.h"
#include "server/surface/tables.h"

struct computation; /* computation.h */

/* The lines that kinks and jumps are those of. */
struct break_lines {
    const struct lines *lines; /* its eye_kind is not LINE_EYE_CAMERA */
    const struct light *lights;
    uint32_t n_lights; /* 1 to MAX_LIGHTS */
};

struct break_counts {
    uint32_t creases;   /* infinitely sharp edges with a face on either side */
    uint32_t semisharp; /* other creases */
    uint32_t joints;    /* pairs of border edges that lie together */
    uint32_t borders;   /* edges with a face on one side */
    uint32_t edges_out; /* over a limit */
    double creases_length, borders_length, out_length;
};

struct breaks_found {
    struct break_counts counts;
    const struct break_edge *edges; /* the worst first; those over a limit before all others */
    size_t n_edges;
    const struct break_vertex *vertices; /* extraordinary ones, in the order of faces */
    size_t n_vertices;
};

/* The largest number of bytes that the computation takes for a surface, with the records of its result. */
uint64_t breaks_bytes(const struct limit_tables *tables);

/* The diagonal of the model's box, units. */
double breaks_diagonal(const struct limit_tables *tables);

/* Copies lights and limits; `tables` must outlive the computation. NULL with ERROR_SERVER when memory is short. */
struct computation *breaks_create(const struct limit_tables *tables,
                                  const struct break_lines *lines,
                                  const struct break_limits *limits, struct error *error);
/* After the last phase. Valid until the computation is destroyed. */
struct breaks_found breaks_result(const struct computation *computation);

#endif
