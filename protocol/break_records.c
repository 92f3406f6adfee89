#include "protocol/break_records.h"

#include <math.h>

#include "protocol/limits.h"
#include "protocol/record_bytes.h"

void break_edge_pack(const struct break_edge *edge, uint8_t bytes[BREAK_EDGE_BYTES])
{
    uint8_t *to = bytes;
    for (int side = 0; side < 2; side++)
        to = record_put(to, edge->face[side], 4);
    for (int side = 0; side < 2; side++)
        to = record_put(to, edge->edge[side], 1);
    to = record_put(to, edge->kind, 1);
    to = record_put(to, edge->over, 1);
    to = record_put(to, edge->kink_light, 1);
    to = record_put(to, edge->jump_light, 1);
    to = record_put(to, edge->has_dart, 1);
    to = record_put(to, 0, 1);
    to = record_put_double(record_put_double(to, edge->length), edge->out_length);
    for (int i = 0; i < BREAK_MEASURES; i++) {
        const struct break_worst *worst = &edge->worst[i];
        to = record_put_double(record_put_double(to, worst->value), worst->at);
        for (int k = 0; k < 3; k++)
            to = record_put_double(to, worst->point[k]);
    }
    record_put_double(to, edge->shift);
}

static bool is_worst(const struct break_worst *worst)
{
    return isnan(worst->value) || (record_is_length(worst->value) && worst->at >= 0 &&
                                   worst->at <= 1 && record_is_point(worst->point));
}

bool break_edge_unpack(const uint8_t bytes[BREAK_EDGE_BYTES], struct break_edge *edge)
{
    const uint8_t *from = bytes;
    for (int side = 0; side < 2; side++)
        edge->face[side] = (uint32_t)record_take(&from, 4);
    for (int side = 0; side < 2; side++)
        edge->edge[side] = (uint8_t)record_take(&from, 1);
    edge->kind = (uint8_t)record_take(&from, 1);
    edge->over = (uint8_t)record_take(&from, 1);
    edge->kink_light = (uint8_t)record_take(&from, 1);
    edge->jump_light = (uint8_t)record_take(&from, 1);
    uint64_t has_dart = record_take(&from, 1);
    edge->has_dart = has_dart == 1;
    from += 1;
    edge->length = record_take_double(&from);
    edge->out_length = record_take_double(&from);
    bool ok = true;
    for (int i = 0; i < BREAK_MEASURES; i++) {
        struct break_worst *worst = &edge->worst[i];
        worst->value = record_take_double(&from);
        worst->at = record_take_double(&from);
        for (int k = 0; k < 3; k++)
            worst->point[k] = record_take_double(&from);
        ok = ok && is_worst(worst);
    }
    edge->shift = record_take_double(&from);
    return ok && edge->edge[0] < 4 && edge->edge[1] < 4 && edge->kind < BREAK_KINDS &&
           edge->over >> BREAK_MEASURES == 0 && edge->kink_light < PROTOCOL_MAX_LIGHTS &&
           edge->jump_light < PROTOCOL_MAX_LIGHTS && has_dart <= 1 &&
           record_is_length(edge->length) && record_is_length(edge->out_length) &&
           (isnan(edge->shift) || record_is_length(edge->shift));
}

void break_vertex_pack(const struct break_vertex *vertex, uint8_t bytes[BREAK_VERTEX_BYTES])
{
    uint8_t *to = record_put(bytes, vertex->face, 4);
    to = record_put(to, vertex->corner, 1);
    to = record_put(to, vertex->is_inside, 1);
    to = record_put(to, vertex->n_faces, 2);
    to = record_put_double(to, vertex->radius);
    to = record_put_double(record_put_double(to, vertex->k_least), vertex->k_greatest);
    for (int k = 0; k < 3; k++)
        to = record_put_double(to, vertex->point[k]);
}

bool break_vertex_unpack(const uint8_t bytes[BREAK_VERTEX_BYTES], struct break_vertex *vertex)
{
    const uint8_t *from = bytes;
    vertex->face = (uint32_t)record_take(&from, 4);
    vertex->corner = (uint8_t)record_take(&from, 1);
    uint64_t is_inside = record_take(&from, 1);
    vertex->is_inside = is_inside == 1;
    vertex->n_faces = (uint16_t)record_take(&from, 2);
    vertex->radius = record_take_double(&from);
    vertex->k_least = record_take_double(&from);
    vertex->k_greatest = record_take_double(&from);
    for (int k = 0; k < 3; k++)
        vertex->point[k] = record_take_double(&from);
    return vertex->corner < 4 && is_inside <= 1 && record_is_length(vertex->radius) &&
           isfinite(vertex->k_least) && isfinite(vertex->k_greatest) &&
           vertex->k_least <= vertex->k_greatest && record_is_point(vertex->point);
}
