/* The records in the DATA of a CURVES answer, packed little-endian; README.md, chapter 10, has their layout. Both sides
 * use these functions. Pure, any thread. */
#ifndef SHEEN_PROTOCOL_CURVE_RECORDS_H
#define SHEEN_PROTOCOL_CURVE_RECORDS_H

#include <stdbool.h>
#include <stdint.h>

#define CURVE_BYTES 32u
#define CURVE_POINT_BYTES 112u
#define CURVE_MARK_BYTES 80u

enum curve_kind { CURVE_LINE, CURVE_SILHOUETTE, CURVE_KINDS };
struct curve_record {
    uint8_t kind;    /* enum curve_kind */
    bool is_closed;  /* the last point is followed by the first */
    uint16_t light;  /* from 0 */
    uint32_t line;   /* number of the line, from 0, of all lights */
    double place;    /* on the light; NaN: a silhouette */
    uint64_t points; /* at least 2 */
    double length;   /* units, of the polyline */
};

struct curve_point_record {
    uint32_t face; /* Ptex face */
    double u, v;
    /* Position; unit normal; unit tangent of the curve, zero where it has none. */
    double point[3], normal[3], along[3];
    double residual; /* place on the light less the line's; NaN: none is met exactly there */
    double length;   /* of the polyline from the curve's first point to here */
};

/* Curves meet or one is a point; the line covers a part of the surface. */
enum curve_mark_kind { CURVE_SINGULAR, CURVE_FLAT, CURVE_MARK_KINDS };
struct curve_mark_record {
    uint8_t kind; /* enum curve_mark_kind */
    uint16_t light;
    uint32_t line, face;
    double u, v, point[3], normal[3]; /* normal: zero if there is none */
};

void curve_pack(const struct curve_record *curve, uint8_t bytes[CURVE_BYTES]);
void curve_point_pack(const struct curve_point_record *point, uint8_t bytes[CURVE_POINT_BYTES]);
void curve_mark_pack(const struct curve_mark_record *mark, uint8_t bytes[CURVE_MARK_BYTES]);
/* False if a number is out of its range. */
bool curve_unpack(const uint8_t bytes[CURVE_BYTES], struct curve_record *curve);
bool curve_point_unpack(const uint8_t bytes[CURVE_POINT_BYTES], struct curve_point_record *point);
bool curve_mark_unpack(const uint8_t bytes[CURVE_MARK_BYTES], struct curve_mark_record *mark);

#endif
