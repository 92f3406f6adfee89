/* The checks of message.h, of requests that compute numbers and of their answers. */
#include <math.h>

#include "protocol/break_records.h"
#include "protocol/message_check.h"

/* Requests of computations have no picture: what only pictures have must be what it is in a request that leaves it
 * out, so that a field which has no influence is not taken for one that has. */
static bool check_scene(const sheen_Render *scene, char *text)
{
    if (!message_check_render(scene, UINT32_MAX, UINT32_MAX, text))
        return false;
    return (!scene->has_surface || scene->surface == sheen_SurfaceKind_SURFACE_EXACT) ||
           check_refuse(text, "surface: numbers are those of the exact surface");
}

bool message_check_find_breaks(const sheen_FindBreaks *asked, char text[static MESSAGE_TEXT_BYTES])
{
    return check_scene(&asked->scene, text) &&
           (!asked->has_gap || check_number(asked->gap, RANGE_GAP, text)) &&
           (!asked->has_angle_deg || check_number(asked->angle_deg, RANGE_ANGLE, text)) &&
           (!asked->has_curvature_percent ||
            check_number(asked->curvature_percent, RANGE_PERCENT, text));
}

bool check_breaks(const sheen_Breaks *breaks, char *text)
{
    const uint64_t bytes = (uint64_t)breaks->edges * BREAK_EDGE_BYTES +
                           (uint64_t)breaks->vertices * BREAK_VERTEX_BYTES;
    const struct {
        const char *name;
        double value;
    } lengths[] = {{"creases_length", breaks->creases_length},
                   {"borders_length", breaks->borders_length},
                   {"out_length", breaks->out_length},
                   {"diagonal", breaks->diagonal}};
    if (breaks->data_bytes != bytes || bytes > PROTOCOL_MAX_FRAME_BYTES)
        return check_refuse(text, "data_bytes is %llu; its records take %llu, and at most %llu",
                            (unsigned long long)breaks->data_bytes, (unsigned long long)bytes,
                            (unsigned long long)PROTOCOL_MAX_FRAME_BYTES);
    if (breaks->edges_out > breaks->edges)
        return check_refuse(text, "edges_out is %u of %u edges", breaks->edges_out, breaks->edges);
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++)
        if (!(lengths[i].value >= 0 && isfinite(lengths[i].value)))
            return check_refuse(text, "%s is no length", lengths[i].name);
    return check_number(breaks->gap, RANGE_GAP, text) &&
           check_number(breaks->angle_deg, RANGE_ANGLE, text) &&
           check_number(breaks->curvature_percent, RANGE_PERCENT, text) &&
           check_whole_scene(&breaks->camera, &breaks->lines, breaks->lights, breaks->lights_count,
                             text) &&
           check_text(breaks->server, "server", text);
}
