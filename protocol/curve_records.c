#include "protocol/curve_records.h"

#include "protocol/record_bytes.h"

static uint8_t *put_doubles(uint8_t *to, const double *value, int n)
{
    for (int i = 0; i < n; i++)
        to = record_put_double(to, value[i]);
    return to;
}

static void take_doubles(const uint8_t **from, double *value, int n)
{
    for (int i = 0; i < n; i++)
        value[i] = record_take_double(from);
}

/* A vector of unit length, to rounding, or zero. */
static bool is_direction(const double v[3])
{
    double square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    return square == 0 || fabs(square - 1) < 1e-6;
}

static bool is_uv(double u, double v)
{
    return u >= 0 && u <= 1 && v >= 0 && v <= 1;
}

void curve_pack(const struct curve_record *curve, uint8_t bytes[CURVE_BYTES])
{
    uint8_t *to = record_put(bytes, curve->kind, 1);
    to = record_put(to, curve->is_closed, 1);
    to = record_put(to, curve->light, 2);
    to = record_put(to, curve->line, 4);
    to = record_put_double(to, curve->place);
    to = record_put(to, curve->points, 8);
    record_put_double(to, curve->length);
}

bool curve_unpack(const uint8_t bytes[CURVE_BYTES], struct curve_record *curve)
{
    const uint8_t *from = bytes;
    curve->kind = (uint8_t)record_take(&from, 1);
    uint64_t is_closed = record_take(&from, 1);
    curve->is_closed = is_closed == 1;
    curve->light = (uint16_t)record_take(&from, 2);
    curve->line = (uint32_t)record_take(&from, 4);
    curve->place = record_take_double(&from);
    curve->points = record_take(&from, 8);
    curve->length = record_take_double(&from);
    return curve->kind < CURVE_KINDS && is_closed <= 1 && curve->light < PROTOCOL_MAX_LIGHTS &&
           curve->points >= 2 && curve->points <= PROTOCOL_MAX_FRAME_BYTES / CURVE_POINT_BYTES &&
           !isinf(curve->place) && record_is_length(curve->length);
}

void curve_point_pack(const struct curve_point_record *point, uint8_t bytes[CURVE_POINT_BYTES])
{
    uint8_t *to = record_put(bytes, point->face, 4);
    to = record_put(to, 0, 4);
    to = record_put_double(record_put_double(to, point->u), point->v);
    to = put_doubles(to, point->point, 3);
    to = put_doubles(to, point->normal, 3);
    to = put_doubles(to, point->along, 3);
    record_put_double(record_put_double(to, point->residual), point->length);
}

bool curve_point_unpack(const uint8_t bytes[CURVE_POINT_BYTES], struct curve_point_record *point)
{
    const uint8_t *from = bytes;
    point->face = (uint32_t)record_take(&from, 4);
    from += 4;
    point->u = record_take_double(&from);
    point->v = record_take_double(&from);
    take_doubles(&from, point->point, 3);
    take_doubles(&from, point->normal, 3);
    take_doubles(&from, point->along, 3);
    point->residual = record_take_double(&from);
    point->length = record_take_double(&from);
    return is_uv(point->u, point->v) && record_is_point(point->point) &&
           is_direction(point->normal) && is_direction(point->along) && !isinf(point->residual) &&
           record_is_length(point->length);
}

void curve_mark_pack(const struct curve_mark_record *mark, uint8_t bytes[CURVE_MARK_BYTES])
{
    uint8_t *to = record_put(bytes, mark->kind, 1);
    to = record_put(to, 0, 1);
    to = record_put(to, mark->light, 2);
    to = record_put(to, mark->line, 4);
    to = record_put(to, mark->face, 4);
    to = record_put(to, 0, 4);
    to = record_put_double(record_put_double(to, mark->u), mark->v);
    put_doubles(put_doubles(to, mark->point, 3), mark->normal, 3);
}

bool curve_mark_unpack(const uint8_t bytes[CURVE_MARK_BYTES], struct curve_mark_record *mark)
{
    const uint8_t *from = bytes;
    mark->kind = (uint8_t)record_take(&from, 1);
    from += 1;
    mark->light = (uint16_t)record_take(&from, 2);
    mark->line = (uint32_t)record_take(&from, 4);
    mark->face = (uint32_t)record_take(&from, 4);
    from += 4;
    mark->u = record_take_double(&from);
    mark->v = record_take_double(&from);
    take_doubles(&from, mark->point, 3);
    take_doubles(&from, mark->normal, 3);
    return mark->kind < CURVE_MARK_KINDS && mark->light < PROTOCOL_MAX_LIGHTS &&
           is_uv(mark->u, mark->v) && record_is_point(mark->point) && is_direction(mark->normal);
}
