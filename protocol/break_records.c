#include "protocol/break_records.h"

#include <math.h>
#include <string.h>

#include "protocol/limits.h"

static uint8_t *put(uint8_t *to, uint64_t value, unsigned n)
{
    for (unsigned i = 0; i < n; i++)
        to[i] = (uint8_t)(value >> (8 * i));
    return to + n;
}

static uint64_t take(const uint8_t **from, unsigned n)
{
    uint64_t value = 0;
    for (unsigned i = 0; i < n; i++)
        value |= (uint64_t)(*from)[i] << (8 * i);
    *from += n;
    return value;
}

static uint8_t *put_double(uint8_t *to, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return put(to, bits, 8);
}

static double take_double(const uint8_t **from)
{
    uint64_t bits = take(from, 8);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

void break_edge_pack(const struct break_edge *edge, uint8_t bytes[BREAK_EDGE_BYTES])
{
    uint8_t *to = bytes;
    for (int side = 0; side < 2; side++)
        to = put(to, edge->face[side], 4);
    for (int side = 0; side < 2; side++)
        to = put(to, edge->edge[side], 1);
    to = put(to, edge->kind, 1);
    to = put(to, edge->over, 1);
    to = put(to, edge->kink_light, 1);
    to = put(to, edge->jump_light, 1);
    to = put(to, edge->has_dart, 1);
    to = put(to, 0, 1);
    to = put_double(put_double(to, edge->length), edge->out_length);
    for (int i = 0; i < BREAK_MEASURES; i++) {
        const struct break_worst *worst = &edge->worst[i];
        to = put_double(put_double(to, worst->value), worst->at);
        for (int k = 0; k < 3; k++)
            to = put_double(to, worst->point[k]);
    }
    put_double(to, edge->shift);
}

static bool is_length(double value)
{
    return value >= 0 && isfinite(value);
}

static bool is_point(const double point[3])
{
    return fabs(point[0]) <= PROTOCOL_MAX_COORDINATE && fabs(point[1]) <= PROTOCOL_MAX_COORDINATE &&
           fabs(point[2]) <= PROTOCOL_MAX_COORDINATE;
}

static bool is_worst(const struct break_worst *worst)
{
    return isnan(worst->value) ||
           (is_length(worst->value) && worst->at >= 0 && worst->at <= 1 && is_point(worst->point));
}

bool break_edge_unpack(const uint8_t bytes[BREAK_EDGE_BYTES], struct break_edge *edge)
{
    const uint8_t *from = bytes;
    for (int side = 0; side < 2; side++)
        edge->face[side] = (uint32_t)take(&from, 4);
    for (int side = 0; side < 2; side++)
        edge->edge[side] = (uint8_t)take(&from, 1);
    edge->kind = (uint8_t)take(&from, 1);
    edge->over = (uint8_t)take(&from, 1);
    edge->kink_light = (uint8_t)take(&from, 1);
    edge->jump_light = (uint8_t)take(&from, 1);
    uint64_t has_dart = take(&from, 1);
    edge->has_dart = has_dart == 1;
    from += 1;
    edge->length = take_double(&from);
    edge->out_length = take_double(&from);
    bool ok = true;
    for (int i = 0; i < BREAK_MEASURES; i++) {
        struct break_worst *worst = &edge->worst[i];
        worst->value = take_double(&from);
        worst->at = take_double(&from);
        for (int k = 0; k < 3; k++)
            worst->point[k] = take_double(&from);
        ok = ok && is_worst(worst);
    }
    edge->shift = take_double(&from);
    return ok && edge->edge[0] < 4 && edge->edge[1] < 4 && edge->kind < BREAK_KINDS &&
           edge->over >> BREAK_MEASURES == 0 && edge->kink_light < PROTOCOL_MAX_LIGHTS &&
           edge->jump_light < PROTOCOL_MAX_LIGHTS && has_dart <= 1 && is_length(edge->length) &&
           is_length(edge->out_length) && (isnan(edge->shift) || is_length(edge->shift));
}

void break_vertex_pack(const struct break_vertex *vertex, uint8_t bytes[BREAK_VERTEX_BYTES])
{
    uint8_t *to = put(bytes, vertex->face, 4);
    to = put(to, vertex->corner, 1);
    to = put(to, vertex->is_inside, 1);
    to = put(to, vertex->n_faces, 2);
    to = put_double(to, vertex->radius);
    to = put_double(put_double(to, vertex->k_least), vertex->k_greatest);
    for (int k = 0; k < 3; k++)
        to = put_double(to, vertex->point[k]);
}

bool break_vertex_unpack(const uint8_t bytes[BREAK_VERTEX_BYTES], struct break_vertex *vertex)
{
    const uint8_t *from = bytes;
    vertex->face = (uint32_t)take(&from, 4);
    vertex->corner = (uint8_t)take(&from, 1);
    uint64_t is_inside = take(&from, 1);
    vertex->is_inside = is_inside == 1;
    vertex->n_faces = (uint16_t)take(&from, 2);
    vertex->radius = take_double(&from);
    vertex->k_least = take_double(&from);
    vertex->k_greatest = take_double(&from);
    for (int k = 0; k < 3; k++)
        vertex->point[k] = take_double(&from);
    return vertex->corner < 4 && is_inside <= 1 && is_length(vertex->radius) &&
           isfinite(vertex->k_least) && isfinite(vertex->k_greatest) &&
           vertex->k_least <= vertex->k_greatest && is_point(vertex->point);
}
