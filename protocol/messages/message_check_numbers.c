/* The checks of message.h, of requests that compute numbers and of their answers. */
#include <math.h>

#include "protocol/break_records.h"
#include "protocol/curve_records.h"
#include "protocol/messages/message_check.h"

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

bool message_check_compare(const sheen_Compare *asked, char text[static MESSAGE_TEXT_BYTES])
{
    return check_scene(&asked->scene, text) &&
           (!asked->has_distance || check_number(asked->distance, RANGE_COMPARE_DISTANCE, text)) &&
           (!asked->has_normal_deg ||
            check_number(asked->normal_deg, RANGE_COMPARE_NORMAL, text)) &&
           (!asked->has_lines || check_number(asked->lines, RANGE_COMPARE_LINES, text)) &&
           (!asked->has_line_length ||
            check_number(asked->line_length, RANGE_COMPARE_LENGTH, text)) &&
           (!asked->has_curvature ||
            check_number(asked->curvature, RANGE_COMPARE_CURVATURE, text)) &&
           (!asked->has_samples || check_number(asked->samples, RANGE_COMPARE_SAMPLES, text));
}

static bool is_quantity(double value)
{
    return value >= 0 && isfinite(value);
}

static bool is_place(const sheen_ComparedPlace *place)
{
    return place->u >= -1e-3 && place->u <= 1.001 && place->v >= -1e-3 && place->v <= 1.001 &&
           isfinite(place->position.x) && isfinite(place->position.y) &&
           isfinite(place->position.z);
}

static bool check_measure(bool has, const sheen_ComparedMeasure *measure, const char *name,
                          char *text)
{
    if (!has)
        return true;
    bool is_right = isfinite(measure->worst) && is_quantity(measure->rms) &&
                    is_quantity(measure->p95) && is_quantity(measure->p99) &&
                    is_quantity(measure->area_out) && is_place(&measure->old) &&
                    is_place(&measure->new);
    return is_right || check_refuse(text, "%s has a number out of its range", name);
}

static bool check_side(const sheen_ComparedSide *side, char *text)
{
    if (!is_quantity(side->area) || !is_quantity(side->area_uncovered) ||
        !is_quantity(side->area_rewound) || !is_quantity(side->area_unlit) ||
        (side->has_uncovered && !is_place(&side->uncovered)))
        return check_refuse(text, "an area or the place of what is missing is out of its range");
    return check_measure(side->has_distance, &side->distance, "distance", text) &&
           check_measure(side->has_normal_deg, &side->normal_deg, "normal_deg", text) &&
           check_measure(side->has_lines, &side->lines, "lines", text) &&
           check_measure(side->has_line_length, &side->line_length, "line_length", text) &&
           check_measure(side->has_curvature, &side->curvature, "curvature", text);
}

static bool check_alignment(const sheen_Alignment *alignment, char *text)
{
    const sheen_Vec3 *const vectors[] = {&alignment->x, &alignment->y, &alignment->z,
                                         &alignment->shift};
    bool is_right = is_quantity(alignment->rotation_deg) && is_quantity(alignment->rms_before) &&
                    is_quantity(alignment->rms_after) && alignment->free <= 6;
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++)
        is_right = is_right && isfinite(vectors[i]->x) && isfinite(vectors[i]->y) &&
                   isfinite(vectors[i]->z);
    return is_right || check_refuse(text, "alignment has a number out of its range");
}

bool check_compared(const sheen_Compared *compared, char *text)
{
    if (!is_quantity(compared->diagonal) || !is_quantity(compared->distance_floor) ||
        !is_quantity(compared->normal_floor_deg))
        return check_refuse(text, "diagonal or a floor is out of its range");
    return check_side(&compared->old, text) && check_side(&compared->new, text) &&
           check_number(compared->distance, RANGE_COMPARE_DISTANCE, text) &&
           check_number(compared->normal_deg, RANGE_COMPARE_NORMAL, text) &&
           check_number(compared->lines, RANGE_COMPARE_LINES, text) &&
           (!compared->has_line_length ||
            check_number(compared->line_length, RANGE_COMPARE_LENGTH, text)) &&
           (!compared->has_curvature ||
            check_number(compared->curvature, RANGE_COMPARE_CURVATURE, text)) &&
           (!compared->has_alignment || check_alignment(&compared->alignment, text)) &&
           check_whole_scene(&compared->camera, &compared->lines_used, compared->lights,
                             compared->lights_count, text) &&
           check_text(compared->server, "server", text);
}

bool message_check_trace_lines(const sheen_TraceLines *asked, char text[static MESSAGE_TEXT_BYTES])
{
    for (size_t i = 0; i < asked->at_count; i++)
        if (!check_number(asked->at[i], RANGE_LINE_PLACE, text))
            return false;
    if (asked->at_count > 0 && asked->has_silhouettes && asked->silhouettes)
        return check_refuse(text, "at is for lines; silhouettes have no places");
    return check_scene(&asked->scene, text) &&
           (!asked->has_tolerance || check_number(asked->tolerance, RANGE_TOLERANCE, text));
}

bool check_curves(const sheen_Curves *curves, char *text)
{
    const uint64_t bytes = (uint64_t)curves->curves * CURVE_BYTES +
                           curves->points * CURVE_POINT_BYTES +
                           (uint64_t)curves->marks * CURVE_MARK_BYTES;
    if (curves->points > PROTOCOL_MAX_FRAME_BYTES || curves->data_bytes != bytes ||
        bytes > PROTOCOL_MAX_FRAME_BYTES)
        return check_refuse(text, "data_bytes is %llu; its records take %llu, and at most %llu",
                            (unsigned long long)curves->data_bytes, (unsigned long long)bytes,
                            (unsigned long long)PROTOCOL_MAX_FRAME_BYTES);
    if (!(curves->diagonal >= 0 && isfinite(curves->diagonal)))
        return check_refuse(text, "diagonal is no length");
    return check_number(curves->tolerance, RANGE_TOLERANCE, text) &&
           check_whole_scene(&curves->camera, &curves->lines, curves->lights, curves->lights_count,
                             text) &&
           check_text(curves->server, "server", text);
}
