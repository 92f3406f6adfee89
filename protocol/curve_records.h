/* The records in the DATA of a CURVES answer, packed little-endian; README.md, chapter 10, has their layout. Both sides
 * use these functions. Pure, any thread. */
#ifndef SHEEN_PROTOCOL_CURVE_RECORDS_H
#define SHEEN_PROTOCOL_CURVE_RECORDS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define CURVE_BYTES 32u
#define CURVE_POINT_BYTES 112u
#define CURVE_MARK_BYTES 80u

enum curve_kind { CURVE_LINE, CURVE_SILHOUETTE };
enum { CURVE_KINDS = CURVE_SILHOUETTE + 1 };

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
    uint32_t face;    /* Ptex face */
    double u, v;      /* on it */
    double point[3];  /* position */
    double normal[3]; /* unit */
    double along[3];  /* unit tangent of the curve; zero: it has none there */
    double residual;  /* place on the light less the line's; NaN: no light is met exactly there */
    double length;    /* of the polyline from the curve's first point to here */
};

enum curve_mark_kind {
    CURVE_SINGULAR, /* curves meet, or a curve is one point */
    CURVE_FLAT,     /* the line covers a part of the surface */
};
enum { CURVE_MARK_KINDS = CURVE_FLAT + 1 };

struct curve_mark_record {
    uint8_t kind; /* enum curve_mark_kind */
    uint16_t light;
    uint32_t line;
    uint32_t face;
    double u, v;
    double point[3];
    double normal[3]; /* zero: there is none */
};

void curve_pack(const struct curve_record *curve, uint8_t bytes[CURVE_BYTES]);
void curve_point_pack(const struct curve_point_record *point, uint8_t bytes[CURVE_POINT_BYTES]);
void curve_mark_pack(const struct curve_mark_record *mark, uint8_t bytes[CURVE_MARK_BYTES]);

/* False if a number is out of its range. */
bool curve_unpack(const uint8_t bytes[CURVE_BYTES], struct curve_record *curve);
bool curve_point_unpack(const uint8_t bytes[CURVE_POINT_BYTES], struct curve_point_record *point);
bool curve_mark_unpack(const uint8_t bytes[CURVE_MARK_BYTES], struct curve_mark_record *mark);

#endif
