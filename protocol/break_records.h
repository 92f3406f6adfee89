/* The records in the DATA of a BREAKS answer, packed little-endian; README.md, chapter 10, has their layout. Both
 * sides use these functions. Pure, any thread. */
#ifndef SHEEN_PROTOCOL_BREAK_RECORDS_H
#define SHEEN_PROTOCOL_BREAK_RECORDS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define BREAK_EDGE_BYTES 280u
#define BREAK_VERTEX_BYTES 56u

enum break_kind {
    BREAK_CREASE,    /* infinitely sharp */
    BREAK_SEMISHARP, /* a crease of finite sharpness */
    BREAK_JOINT, /* borders that lie together, or a curve across which only the curvature jumps */
};
enum { BREAK_KINDS = BREAK_JOINT + 1 };

/* What is measured at an edge; README.md says how. */
enum break_measure {
    BREAK_GAP,       /* units */
    BREAK_ANGLE,     /* degrees */
    BREAK_CURVATURE, /* 1/unit */
    BREAK_PERCENT,   /* the same, percent of the mean of both curvatures */
    BREAK_KINK,      /* degrees */
    BREAK_JUMP,      /* spacings of lines */
};
enum { BREAK_MEASURES = BREAK_JUMP + 1 };

/* A measure at its worst place on the edge. NaN: it has no value anywhere on the edge, for example because no light
 * is met. */
struct break_worst {
    double value;
    double at;       /* from 0, at the corner `edge` of the face, to 1 at the next corner */
    double point[3]; /* position */
};

/* over: bits of enum break_measure, for the measures that exceed their limit. */
struct break_edge {
    uint32_t face[2]; /* Ptex faces on both sides */
    uint8_t edge[2];  /* of each face: from corner `edge` to the next one */
    uint8_t kind;     /* enum break_kind */
    uint8_t over;
    uint8_t kink_light, jump_light; /* index of the light for which kink and jump are worst */
    bool has_dart;                  /* the crease ends at one of its vertices */
    double length, out_length;      /* of the edge; of its part over a limit */
    struct break_worst worst[BREAK_MEASURES];
    double shift; /* units: the jump's length on the surface, where the jump is worst; NaN: none */
};

struct break_vertex {
    uint32_t face;    /* a face at the vertex */
    uint8_t corner;   /* its corner there */
    bool is_inside;   /* faces all around it, and no crease but one that ends there */
    uint16_t n_faces; /* around it, or between two creases or borders */
    double radius;    /* units: of the ring on which the curvature is measured, in the mean */
    double k_least, k_greatest; /* principal curvatures on the ring, 1/unit */
    double point[3];
};

void break_edge_pack(const struct break_edge *edge, uint8_t bytes[BREAK_EDGE_BYTES]);
void break_vertex_pack(const struct break_vertex *vertex, uint8_t bytes[BREAK_VERTEX_BYTES]);
/* False if a value is none that a server may send: then *edge or *vertex is undefined. */
bool break_edge_unpack(const uint8_t bytes[BREAK_EDGE_BYTES], struct break_edge *edge);
bool break_vertex_unpack(const uint8_t bytes[BREAK_VERTEX_BYTES], struct break_vertex *vertex);

#endif
