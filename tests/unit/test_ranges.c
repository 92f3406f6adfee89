/* One table of ranges for all: at both ends of each range, just inside and just outside, the
 * command line, the check of messages and the renderer decide equally. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/messages/message_values.h"
#include "client/cli/commands.h"
#include "protocol/limits.h"
#include "protocol/messages/message.h"
#include "protocol/ranges.h"
#include "server/scene/request_check.h"
#include "server/scene/scene_convert.h"
#include "tests/unit/good_render.h"

#define RENDER "m.obj -o a.png "
#define STREAM "m.obj --frames 5 "

static enum options_result parse(const struct command *command, const char *line)
{
    static char copy[4000]; /* the options point into this copy of the line */
    char *argv[64], why[OPTIONS_WHY_BYTES];
    struct options options;
    int argc = 0;
    snprintf(copy, sizeof(copy), "%s %s", command->name, line);
    for (char *word = strtok(copy, " "); word; word = strtok(NULL, " "))
        argv[argc++] = word;
    argv[argc] = NULL;
    return options_parse(command, argc, argv, &options, why);
}

/* --- the fields */

#define WIRE(name, ...)                                                                            \
    static void wire_##name(sheen_Render *render, double value)                                    \
    {                                                                                              \
        __VA_ARGS__;                                                                               \
    }
#define FRAME(name, ...)                                                                           \
    static void frame_##name(struct frame_request *frame, double value)                            \
    {                                                                                              \
        __VA_ARGS__;                                                                               \
    }
#define BOTH(name, in_wire, in_frame) WIRE(name, in_wire = value) FRAME(name, in_frame = value)
#define PATTERN(name)                                                                              \
    WIRE(name, render->lights[0].pattern.has_##name = true;                                        \
         render->lights[0].pattern.name = value)                                                   \
    FRAME(name, frame->lights[0].pattern.name = value)

WIRE(width, render->width_px = (uint32_t)value)
FRAME(width, frame->width_px = (uint32_t)value)
WIRE(height, render->height_px = (uint32_t)value)
FRAME(height, frame->height_px = (uint32_t)value)
WIRE(jpeg, render->height_px = (uint32_t)value; render->encoding = sheen_Encoding_ENCODING_JPEG)
/* Neither in the plane of the light nor along up. */
WIRE(eye, render->camera.eye.x = render->camera.eye.z = value)
FRAME(eye, frame->camera.eye[0] = frame->camera.eye[2] = value)
BOTH(target, render->camera.target.y, frame->camera.target[1])
BOTH(upward, render->camera.up.x, frame->camera.up[0])
BOTH(centre, render->lights[0].centre.z, frame->lights[0].centre[2])
WIRE(direction, render->lines = (sheen_Lines){.family = sheen_LineFamily_LINES_ZEBRA,
                                              .has_direction = true,
                                              .direction = {value, 0, 1}})
FRAME(direction, frame->lines = (struct lines){
                     .family = LINES_ZEBRA, .has_direction = true, .direction = {value, 0, 1}})
WIRE(line_eye, render->lines.family = sheen_LineFamily_LINES_HIGHLIGHT;
     render->lines.has_eye = true; render->lines.eye = (sheen_Vec3){1, value, 9})
FRAME(line_eye, frame->lines.family = LINES_HIGHLIGHT; frame->lines.eye_kind = LINE_EYE_POINT;
      frame->lines.eye[0] = 1; frame->lines.eye[1] = value; frame->lines.eye[2] = 9)
WIRE(line_look, render->lines.has_eye_direction = true;
     render->lines.eye_direction = (sheen_Vec3){1, value, 0})
FRAME(line_look, frame->lines.eye_kind = LINE_EYE_DIRECTION; frame->lines.eye[0] = 1;
      frame->lines.eye[1] = value; frame->lines.eye[2] = 0)
WIRE(pull, render->show = (sheen_Show){.kind = sheen_ShowKind_SHOW_DRAFT,
                                       .has_direction = true,
                                       .direction = {0, 1, value}})

/* A part of 1x1 pixels, so that it is inside of every picture. */
static void wire_window(sheen_Render *render, double x, double y, double width, double height)
{
    render->width_px = render->height_px = 1;
    render->has_window = true;
    render->window = (sheen_Window){x, y, (uint32_t)width, (uint32_t)height};
}
static void frame_window(struct frame_request *frame, double x, double y, double width,
                         double height)
{
    frame->width_px = frame->height_px = 1;
    frame->camera.window = (struct camera_window){x, y, (uint32_t)width, (uint32_t)height};
}
WIRE(window_x, wire_window(render, value, 0, 65536, 9))
FRAME(window_x, frame_window(frame, value, 0, 65536, 9))
WIRE(window_y, wire_window(render, 0, value, 9, 65536))
FRAME(window_y, frame_window(frame, 0, value, 9, 65536))
WIRE(window_width, wire_window(render, 0, 0, value, 9))
FRAME(window_width, frame_window(frame, 0, 0, value, 9))
WIRE(window_height, wire_window(render, 0, 0, 9, value))
FRAME(window_height, frame_window(frame, 0, 0, 9, value))
BOTH(fov_deg, render->camera.fov_deg, frame->camera.fov_deg)
WIRE(ortho_height, render->camera.has_fov_deg = false; render->camera.has_ortho_height = true;
     render->camera.ortho_height = value)
FRAME(ortho_height, frame->camera.kind = CAMERA_ORTHOGRAPHIC; frame->camera.ortho_height = value)
WIRE(zoom, render->camera.has_zoom = true; render->camera.zoom = value)
WIRE(zoom_x, render->camera.has_zoom_x = true; render->camera.zoom_x = value)
WIRE(zoom_y, render->camera.has_zoom_y = true; render->camera.zoom_y = value)
WIRE(edge_u, render->lines.family = sheen_LineFamily_LINES_HIGHLIGHT;
     render->lights[0].u = (sheen_Vec3){value, 0, 0})
FRAME(edge_u, frame->lines.family = LINES_HIGHLIGHT; frame->lights[0].u[0] = value)
WIRE(edge_v, render->lines.family = sheen_LineFamily_LINES_HIGHLIGHT;
     render->lights[0].v = (sheen_Vec3){0, value, 0})
FRAME(edge_v, frame->lines.family = LINES_HIGHLIGHT; frame->lights[0].v[1] = value)
PATTERN(count)
PATTERN(period)
PATTERN(duty)
PATTERN(rotation_deg)
PATTERN(offset)
PATTERN(soft)
PATTERN(opacity)

static void wire_lines(sheen_Render *render, double n, double at, double width)
{
    sheen_Pattern *pattern = &render->lights[0].pattern;
    pattern->kind = sheen_PatternKind_PATTERN_LINES;
    pattern->has_width = true;
    pattern->width = width;
    pattern->at_count = (pb_size_t)n;
    pattern->at[0] = at;
}
static void frame_lines(struct frame_request *frame, double n, double at, double width)
{
    struct pattern *pattern = &frame->lights[0].pattern;
    pattern->kind = PATTERN_LINES;
    pattern->width = width;
    pattern->n_at = (uint32_t)n;
    pattern->at[0] = at;
}
WIRE(n_lines, wire_lines(render, value, 0, 0.1))
FRAME(n_lines, frame_lines(frame, value, 0, 0.1))
WIRE(at, wire_lines(render, 1, value, 0.1))
FRAME(at, frame_lines(frame, 1, value, 0.1))
WIRE(line_width, wire_lines(render, 1, 0, value))
FRAME(line_width, frame_lines(frame, 1, 0, value))

static void wire_lights(sheen_Render *render, double n)
{
    render->lights_count = (pb_size_t)n;
    for (pb_size_t i = 1; i < render->lights_count; i++)
        render->lights[i] = render->lights[0];
}
static void frame_lights(struct frame_request *frame, double n)
{
    frame->n_lights = n < 1 ? 1 : (uint32_t)n; /* the daemon adds a light if there is none */
    for (uint32_t i = 1; i < frame->n_lights && i < MAX_LIGHTS; i++)
        frame->lights[i] = frame->lights[0];
}

WIRE(colour, render->lights[0].pattern.foreground.r = (float)value)
FRAME(colour, frame->lights[0].pattern.foreground[0] = (float)value)
WIRE(dark, render->lights[0].pattern.background.a = (float)value)
FRAME(dark, frame->lights[0].pattern.background[3] = (float)value)
WIRE(miss, render->miss.g = (float)value)
FRAME(miss, frame->miss[1] = (float)value)
WIRE(empty, render->empty.b = (float)value)
FRAME(empty, frame->empty[2] = (float)value)
WIRE(base, render->has_base = true; render->base.a = (float)value)
FRAME(base, frame->base[3] = (float)value)
WIRE(mean, render->show = (sheen_Show){
               .kind = sheen_ShowKind_SHOW_MEAN, .has_range = true, .range = value})
WIRE(draft, render->show = (sheen_Show){.kind = sheen_ShowKind_SHOW_DRAFT,
                                        .has_direction = true,
                                        .direction = {0, 0, 1},
                                        .has_range = true,
                                        .range = value})
WIRE(level, render->has_surface = render->has_surface_level = true;
     render->surface = sheen_SurfaceKind_SURFACE_POLYGON; render->surface_level = (uint32_t)value)
FRAME(level, frame->surface = (struct surface){SURFACE_POLYGON, (uint32_t)value})
WIRE(jpeg_quality, render->encoding = sheen_Encoding_ENCODING_JPEG; render->has_jpeg_quality = true;
     render->jpeg_quality = (uint32_t)value)
WIRE(deadline, render->has_deadline_ms = true; render->deadline_ms = (uint32_t)value)

enum kind { REAL, WHOLE, SINGLE /* of single precision */ };

static const struct field {
    const struct range *range;
    enum kind kind;
    /* a command line of sheen render with the number in its place; NULL: no option sets this
     * field */
    const char *line;
    void (*wire)(sheen_Render *render, double value);
    void (*frame)(struct frame_request *frame,
                  double value); /* NULL: the renderer has no such field */
} FIELDS[] = {
    {&RANGES[RANGE_SIDE], WHOLE, RENDER "--size %.17gx64", wire_width, frame_width},
    {&RANGES[RANGE_SIDE], WHOLE, RENDER "--size 64x%.17g", wire_height, frame_height},
    {&RANGES[RANGE_JPEG_SIDE], WHOLE, "m.obj -o a.jpg --size 64x%.17g", wire_jpeg, NULL},
    {&RANGES[RANGE_WINDOW_AT], REAL, NULL, wire_window_x, frame_window_x},
    {&RANGES[RANGE_WINDOW_AT], REAL, NULL, wire_window_y, frame_window_y},
    {&RANGES[RANGE_WINDOW_SIDE], WHOLE, NULL, wire_window_width, frame_window_width},
    {&RANGES[RANGE_WINDOW_SIDE], WHOLE, NULL, wire_window_height, frame_window_height},
    {&RANGES[RANGE_COORDINATE], REAL, RENDER "--eye %.17g,-4,2 --target 0,0,0", wire_eye,
     frame_eye},
    {&RANGES[RANGE_COORDINATE], REAL, RENDER "--eye 3,-4,2 --target 0,%.17g,0", wire_target,
     frame_target},
    {&RANGES[RANGE_COORDINATE], REAL, RENDER "--up %.17g,0,1", wire_upward, frame_upward},
    {&RANGES[RANGE_COORDINATE], REAL,
     RENDER "--light-center 0,0,%.17g --light-u 4,0,0 --light-v 0,4,0", wire_centre, frame_centre},
    {&RANGES[RANGE_COORDINATE], REAL, RENDER "--lines zebra:%.17g,0,1", wire_direction,
     frame_direction},
    {&RANGES[RANGE_COORDINATE], REAL, RENDER "--line-eye 1,%.17g,9", wire_line_eye, frame_line_eye},
    {&RANGES[RANGE_COORDINATE], REAL, RENDER "--line-eye dir:1,%.17g,0", wire_line_look,
     frame_line_look},
    {&RANGES[RANGE_COORDINATE], REAL, RENDER "--show draft:0,1,%.17g", wire_pull, NULL},
    {&RANGES[RANGE_FOV], REAL, RENDER "--fov %.17g", wire_fov_deg, frame_fov_deg},
    {&RANGES[RANGE_ORTHO_HEIGHT], REAL, RENDER "--ortho %.17g", wire_ortho_height,
     frame_ortho_height},
    {&RANGES[RANGE_ZOOM], REAL, RENDER "--zoom %.17g", wire_zoom, NULL},
    {&RANGES[RANGE_ZOOM_AT], REAL, RENDER "--zoom 2@%.17g,0.5", wire_zoom_x, NULL},
    {&RANGES[RANGE_ZOOM_AT], REAL, RENDER "--zoom 2@0.5,%.17g", wire_zoom_y, NULL},
    {&RANGES[RANGE_LIGHTS], WHOLE, NULL, wire_lights, frame_lights},
    {&RANGES[RANGE_LIGHT_SIDE], REAL,
     RENDER "--light-center 0,0,4 --light-u %.17g,0,0 --light-v 0,4,0", wire_edge_u, frame_edge_u},
    {&RANGES[RANGE_LIGHT_SIDE], REAL,
     RENDER "--light-center 0,0,4 --light-u 4,0,0 --light-v 0,%.17g,0", wire_edge_v, frame_edge_v},
    {&RANGES[RANGE_PATTERN_COUNT], REAL, RENDER "--pattern stripes:count=%.17g", wire_count,
     frame_count},
    {&RANGES[RANGE_PATTERN_PERIOD], REAL, RENDER "--pattern stripes:period=%.17g", wire_period,
     frame_period},
    {&RANGES[RANGE_PATTERN_DUTY], REAL, RENDER "--pattern stripes:duty=%.17g", wire_duty,
     frame_duty},
    {&RANGES[RANGE_PATTERN_ROTATION], REAL, RENDER "--pattern lattice:rotation=%.17g",
     wire_rotation_deg, frame_rotation_deg},
    {&RANGES[RANGE_PATTERN_OFFSET], REAL, RENDER "--pattern circles:offset=%.17g", wire_offset,
     frame_offset},
    {&RANGES[RANGE_PATTERN_SOFT], REAL, RENDER "--pattern stripes:soft=%.17g", wire_soft,
     frame_soft},
    {&RANGES[RANGE_PATTERN_OPACITY], REAL, RENDER "--pattern stripes:opacity=%.17g", wire_opacity,
     frame_opacity},
    {&RANGES[RANGE_PATTERN_LINES], WHOLE, NULL, wire_n_lines, frame_n_lines},
    {&RANGES[RANGE_PATTERN_AT], REAL, RENDER "--pattern lines:at=0.5/%.17g", wire_at, frame_at},
    {&RANGES[RANGE_PATTERN_WIDTH], REAL, RENDER "--pattern lines:width=%.17g", wire_line_width,
     frame_line_width},
    {&RANGES[RANGE_COLOUR], SINGLE, NULL, wire_colour, frame_colour},
    {&RANGES[RANGE_COLOUR], SINGLE, NULL, wire_dark, frame_dark},
    {&RANGES[RANGE_COLOUR], SINGLE, NULL, wire_miss, frame_miss},
    {&RANGES[RANGE_COLOUR], SINGLE, NULL, wire_empty, frame_empty},
    {&RANGES[RANGE_COLOUR], SINGLE, NULL, wire_base, frame_base},
    {&RANGES[RANGE_SHOW_CURVATURE], REAL, RENDER "--show-range %.17g --show mean", wire_mean, NULL},
    {&RANGES[RANGE_SHOW_DRAFT], REAL, RENDER "--show-range %.17g --show draft:0,0,1", wire_draft,
     NULL},
    {&RANGES[RANGE_JPEG_QUALITY], WHOLE, "m.obj -o a.jpg --jpeg-quality %.17g", wire_jpeg_quality,
     NULL},
    {&RANGES[RANGE_LEVEL], WHOLE, RENDER "--surface polygon:%.17g", wire_level, frame_level},
    {&RANGES[RANGE_DEADLINE], WHOLE, RENDER "--deadline %.17g", wire_deadline, NULL},
    {&OPTION_RANGES[OPTION_RANGE_FRAMES], WHOLE, "m.obj --frames %.17g", NULL, NULL},
    {&OPTION_RANGES[OPTION_RANGE_ORBIT], REAL, STREAM "--orbit %.17g", NULL, NULL},
    {&OPTION_RANGES[OPTION_RANGE_RECONNECT], WHOLE, STREAM "--reconnect %.17g", NULL, NULL},
    {&OPTION_RANGES[OPTION_RANGE_SAMPLES], WHOLE, "m.obj --section 0,0,9,9 --samples %.17g", NULL,
     NULL},
};
#define N_FIELDS (sizeof(FIELDS) / sizeof(*FIELDS))

/* --- the decision of each of the three */

/* How many elements: the value of `n`. */
static bool client_takes_count(const struct range *range, double n)
{
    char line[1000] = RENDER;
    bool is_lights = range == &RANGES[RANGE_LIGHTS];
    strcat(line, is_lights ? "" : "--pattern lines:at=");
    for (int i = 0; i < (int)n; i++)
        strcat(line, is_lights ? "--light plane " : i ? "/0" : "0");
    return parse(&COMMAND_RENDER, line) == OPTIONS_RUN;
}

static bool client_takes(const struct field *field, double value)
{
    char line[400];
    if (!field->line)
        return client_takes_count(field->range, value);
    _Pragma("GCC diagnostic push") _Pragma("GCC diagnostic ignored \"-Wformat-nonliteral\"");
    snprintf(line, sizeof(line), field->line, value);
    _Pragma("GCC diagnostic pop");
    const struct command *command = field->wire ? &COMMAND_RENDER : &COMMAND_STREAM;
    if (field->range == &OPTION_RANGES[OPTION_RANGE_SAMPLES])
        command = &COMMAND_PICK;
    return parse(command, line) == OPTIONS_RUN;
}

static bool message_takes(const struct field *field, double value)
{
    char text[MESSAGE_TEXT_BYTES];
    sheen_Render render = GOOD;
    /* More elements than the struct holds are refused when a message is decoded
     * (protocol/sheen.options). */
    if (field->range == &RANGES[RANGE_LIGHTS] && value > sizeof GOOD.lights / sizeof *GOOD.lights)
        return false;
    if (field->range == &RANGES[RANGE_PATTERN_LINES] &&
        value > sizeof GOOD.lights->pattern.at / sizeof *GOOD.lights->pattern.at)
        return false;
    field->wire(&render, value);
    return message_check_render(&render, UINT32_MAX, UINT32_MAX, text);
}

/* Fields that a request leaves out are taken from this model. */
static const struct limit_tables TABLES = {.box_min = {-1, -1, -1}, .box_max = {1, 1, 1}};
static const struct scene_subject SUBJECT = {&TABLES, CAGE_UP_UNSAID};

static bool renderer_takes(const struct field *field, double value)
{
    struct frame_request frame;
    struct error error = {0};
    scene_read_request(&GOOD, &SUBJECT, &frame);
    assert_true(request_check(&frame, PROTOCOL_MAX_SIZE_PX, PROTOCOL_MAX_SIZE_PX, &error));
    field->frame(&frame, value);
    return request_check(&frame, PROTOCOL_MAX_SIZE_PX, PROTOCOL_MAX_SIZE_PX, &error);
}

static void all_say(const struct field *field, double value, bool takes)
{
    const char *option = field->range->option, *name = option ? option : field->range->field;
    bool has_option = field->line || (option && value >= 0);
    if (has_option && client_takes(field, value) != takes)
        fail_msg("the client on %s %.17g, of '%s'", name, value, field->line ? field->line : "");
    if (value < 0 && field->kind == WHOLE)
        return; /* the message has no such number */
    if (field->wire && message_takes(field, value) != takes)
        fail_msg("the message's check on %s %.17g, field %zu", name, value,
                 (size_t)(field - FIELDS));
    if (field->frame && renderer_takes(field, value) != takes)
        fail_msg("the renderer on %s %.17g, field %zu", name, value, (size_t)(field - FIELDS));
}

static double next(enum kind kind, double value, double towards)
{
    if (kind == WHOLE)
        return value + (towards > value ? 1 : -1);
    return kind == SINGLE ? (double)nextafterf((float)value, (float)towards)
                          : nextafter(value, towards);
}

static void all_agree_at_each_end(void **state)
{
    (void)state;
    for (size_t i = 0; i < N_FIELDS; i++) {
        const struct range *range = FIELDS[i].range;
        double above = next(FIELDS[i].kind, range->least, INFINITY);
        double below = next(FIELDS[i].kind, range->least, -INFINITY);
        all_say(&FIELDS[i], range->least, !range->above_least);
        all_say(&FIELDS[i], above, true);
        all_say(&FIELDS[i], below, false);
        all_say(&FIELDS[i], range->greatest, true);
        all_say(&FIELDS[i], next(FIELDS[i].kind, range->greatest, INFINITY), false);
        if (FIELDS[i].kind != WHOLE && FIELDS[i].wire) {
            assert_false(message_takes(&FIELDS[i], (double)NAN));
            assert_false(FIELDS[i].frame && renderer_takes(&FIELDS[i], (double)NAN));
        }
    }
}

/* --- the numbers of computations, which no RENDER has */

static const enum range_name LIMITS[] = {RANGE_GAP, RANGE_ANGLE, RANGE_PERCENT, RANGE_TOLERANCE,
                                         RANGE_LINE_PLACE};
#define N_LIMITS (sizeof LIMITS / sizeof *LIMITS)

static bool limit_is_taken(size_t i, double value)
{
    char text[MESSAGE_TEXT_BYTES];
    sheen_FindBreaks asked = {.scene = GOOD};
    bool *const has[] = {&asked.has_gap, &asked.has_angle_deg, &asked.has_curvature_percent};
    double *const member[] = {&asked.gap, &asked.angle_deg, &asked.curvature_percent};
    sheen_TraceLines lines = {.scene = GOOD};
    if (LIMITS[i] == RANGE_TOLERANCE || LIMITS[i] == RANGE_LINE_PLACE) {
        lines.has_tolerance = LIMITS[i] == RANGE_TOLERANCE;
        lines.at_count = LIMITS[i] == RANGE_LINE_PLACE;
        lines.tolerance = lines.at[0] = value;
        return message_check_trace_lines(&lines, text);
    }
    *has[i] = true;
    *member[i] = value;
    return message_check_find_breaks(&asked, text);
}

static void limits_of_breaks_agree_at_each_end(void **state)
{
    (void)state;
    for (size_t i = 0; i < N_LIMITS; i++) {
        const struct range *range = &RANGES[LIMITS[i]];
        assert_int_equal(limit_is_taken(i, range->least), !range->above_least);
        assert_false(limit_is_taken(i, next(REAL, range->least, -INFINITY)));
        assert_true(limit_is_taken(i, next(REAL, range->least, INFINITY)));
        assert_true(limit_is_taken(i, range->greatest));
        assert_false(limit_is_taken(i, next(REAL, range->greatest, INFINITY)));
        assert_false(limit_is_taken(i, (double)NAN));
    }
}

/* --- the numbers that only a COMPARE has; the last one is whole */

static const enum range_name COMPARED[] = {RANGE_COMPARE_DISTANCE,  RANGE_COMPARE_NORMAL,
                                           RANGE_COMPARE_LINES,     RANGE_COMPARE_LENGTH,
                                           RANGE_COMPARE_CURVATURE, RANGE_COMPARE_SAMPLES};
#define N_COMPARED (sizeof COMPARED / sizeof *COMPARED)

static bool compare_is_taken(size_t i, double value)
{
    char text[MESSAGE_TEXT_BYTES];
    sheen_Compare asked = {.scene = GOOD, .has_samples = i == N_COMPARED - 1};
    bool *const has[] = {&asked.has_distance, &asked.has_normal_deg, &asked.has_lines,
                         &asked.has_line_length, &asked.has_curvature};
    double *const member[] = {&asked.distance, &asked.normal_deg, &asked.lines, &asked.line_length,
                              &asked.curvature};
    if (asked.has_samples) {
        asked.samples = (uint32_t)value;
    } else {
        *has[i] = true;
        *member[i] = value;
    }
    return message_check_compare(&asked, text);
}

static void numbers_of_comparisons_agree_at_each_end(void **state)
{
    (void)state;
    for (size_t i = 0; i < N_COMPARED; i++) {
        const struct range *range = &RANGES[COMPARED[i]];
        enum kind kind = i == N_COMPARED - 1 ? WHOLE : REAL;
        assert_int_equal(compare_is_taken(i, range->least), !range->above_least);
        assert_true(compare_is_taken(i, next(kind, range->least, INFINITY)));
        assert_false(compare_is_taken(i, next(kind, range->least, -INFINITY)));
        assert_true(compare_is_taken(i, range->greatest));
        assert_false(compare_is_taken(i, next(kind, range->greatest, INFINITY)));
        assert_false(kind == REAL && compare_is_taken(i, (double)NAN));
    }
}

static bool is_limit(const struct range *range)
{
    for (size_t i = 0; i < N_COMPARED; i++)
        if (range == &RANGES[COMPARED[i]])
            return true;
    for (size_t i = 0; i < N_LIMITS; i++)
        if (range == &RANGES[LIMITS[i]])
            return true;
    return false;
}

/* FIELDS, LIMITS or COMPARED have every range of the table. */
static void every_range_is_tried(void **state)
{
    (void)state;
    for (size_t k = 0; k < N_RANGES + N_OPTION_RANGES; k++) {
        const struct range *range = k < N_RANGES ? &RANGES[k] : &OPTION_RANGES[k - N_RANGES];
        size_t i = 0;
        while (i < N_FIELDS && FIELDS[i].range != range)
            i++;
        if (i == N_FIELDS && !is_limit(range))
            fail_msg("%s is not tried", range->field ? range->field : range->option);
    }
}

/* Rules about several numbers: equal points, zero directions, parallel directions. The check of
 * messages and the renderer draw the line at the same value. */
static void directions_agree(void **state)
{
    (void)state;
    char text[MESSAGE_TEXT_BYTES];
    unsigned n_refused = 0, n_taken = 0;
    srand(7);
    for (int i = 0; i < 20000; i++) {
        sheen_Render render = GOOD;
        render.lines.family = sheen_LineFamily_LINES_HIGHLIGHT; /* the eye may be anywhere else */
        double size = pow(10, -32 + 64.0 * rand() / RAND_MAX);
        double sine = pow(10, -12 + 6.0 * rand() / RAND_MAX);
        switch (i % 4) {
        case 0:
            render.camera.eye = (sheen_Vec3){size, 0, 0};
            render.camera.target = (sheen_Vec3){0, 0, 0};
            break;
        case 1:
            render.camera.up = (sheen_Vec3){-3 + 4 * sine, 4 + 3 * sine, -2};
            break;
        case 2:
            render.lights[0].v = (sheen_Vec3){1, sine, 0};
            break;
        default:
            render.lines.has_eye_direction = true;
            render.lines.eye_direction = (sheen_Vec3){0, fmin(size, 1e30), 0};
        }
        struct frame_request frame;
        struct error error = {0};
        scene_read_request(&render, &SUBJECT, &frame);
        /* the request's own up, in case the default camera replaced it because it is parallel */
        message_read_vec3(&render.camera.up, frame.camera.up);
        bool is_taken = message_check_render(&render, 16384, 16384, text);
        if (request_check(&frame, 16384, 16384, &error) != is_taken)
            fail_msg("case %d: message %d '%s', renderer '%s'", i, is_taken, text, error.text);
        n_taken += is_taken;
        n_refused += !is_taken;
    }
    assert_true(n_taken > 5000 && n_refused > 2000);
}

static void ranges_read_well(void **state)
{
    (void)state;
    char text[RANGE_TEXT_BYTES];
    assert_string_equal(range_text(&RANGES[RANGE_FOV], text), "from 1e-6 to 179 degrees");
    assert_string_equal(range_text(&RANGES[RANGE_COORDINATE], text), "from -1e30 to 1e30");
    assert_string_equal(range_text(&RANGES[RANGE_PATTERN_COUNT], text),
                        "above 0 and at most 100000");
    assert_string_equal(range_text(&RANGES[RANGE_DEADLINE], text),
                        "from 1 to 3600000 milliseconds");
    const struct range small = {NULL, NULL, -1e-100, 2.5e-10, false, ""};
    assert_string_equal(range_text(&small, text), "from -1e-100 to 2.5e-10");
}

int main(void)
{
    unsetenv("SHEEN_SERVER");
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_agree_at_each_end),
        cmocka_unit_test(limits_of_breaks_agree_at_each_end),
        cmocka_unit_test(numbers_of_comparisons_agree_at_each_end),
        cmocka_unit_test(every_range_is_tried),
        cmocka_unit_test(directions_agree),
        cmocka_unit_test(ranges_read_well),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
