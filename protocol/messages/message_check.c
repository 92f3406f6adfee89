/* The checks of message.h, of greetings, files and answers, for rules that the schema cannot express. */
#include <math.h>
#include <string.h>

#include "protocol/codec.h"
#include "protocol/messages/message_check.h"
#include "protocol/ranges.h"

bool message_check_model_query(const sheen_ModelQuery *query, char text[static MESSAGE_TEXT_BYTES])
{
    static const uint8_t zeros[sizeof query->sha256] = {0};
    if (!query->has_file)
        return true;
    if (memcmp(query->sha256, zeros, sizeof zeros) != 0)
        return check_refuse(text, "sha256 and file exclude each other: with file, sha256 is zeros");
    return (*query->file || check_refuse(text, "file is empty")) &&
           check_text(query->file, "file", text);
}

bool message_check_hello(const sheen_Hello *hello, char text[static MESSAGE_TEXT_BYTES])
{
    return check_text(hello->client, "client", text);
}

bool message_check_upload_begin(const sheen_UploadBegin *begin,
                                char text[static MESSAGE_TEXT_BYTES])
{
    if (!check_enum(begin->kind, sheen_UploadKind_UPLOAD_IMAGE, "kind", text) ||
        !check_text(begin->name, "name", text))
        return false;
    return (begin->size_bytes > 0 && begin->size_bytes <= PROTOCOL_MAX_UPLOAD_BYTES) ||
           check_refuse(text, "size_bytes is %llu; it must be from 1 to %llu",
                        (unsigned long long)begin->size_bytes,
                        (unsigned long long)PROTOCOL_MAX_UPLOAD_BYTES);
}

static bool check_extreme(const sheen_Frame *frame, const sheen_Extreme *extreme, const char *field,
                          char *text)
{
    if (!isfinite(extreme->value))
        return check_refuse(text, "%s.value is no finite number", field);
    if (extreme->has_x_px != extreme->has_y_px || extreme->has_x_px != extreme->has_position ||
        extreme->x_px >= frame->width_px || extreme->y_px >= frame->height_px)
        return check_refuse(text, "%s has no pixel of the frame, with its position", field);
    if (extreme->has_face != extreme->has_u || extreme->has_u != extreme->has_v ||
        !(extreme->u >= 0 && extreme->u <= 1 && extreme->v >= 0 && extreme->v <= 1))
        return check_refuse(text, "%s: face, u and v come together, u and v from 0 to 1", field);
    return !extreme->has_position || check_vec3(&extreme->position, field, text);
}

static bool check_extremes(const sheen_Frame *frame, char *text)
{
    if (frame->has_show_least != frame->has_show_greatest)
        return check_refuse(text, "show_least and show_greatest come together");
    if (!frame->has_show_least)
        return true;
    return check_extreme(frame, &frame->show_least, "show_least", text) &&
           check_extreme(frame, &frame->show_greatest, "show_greatest", text) &&
           (frame->show_least.value <= frame->show_greatest.value ||
            check_refuse(text, "show_least is above show_greatest"));
}

static bool check_frame(const sheen_Frame *frame, char *text)
{
    struct codec_layout layout;
    if (!check_planes(frame->planes, frame->encoding, text))
        return false;
    if (!codec_layout_init(&layout, frame->width_px, frame->height_px, frame->planes))
        return check_refuse(text, "%ux%u px is no frame's size", frame->width_px, frame->height_px);
    if (frame->data_bytes == 0 || frame->data_bytes > PROTOCOL_MAX_FRAME_BYTES)
        return check_refuse(text, "data_bytes is %llu; it must be from 1 to %llu",
                            (unsigned long long)frame->data_bytes,
                            (unsigned long long)PROTOCOL_MAX_FRAME_BYTES);
    if (frame->has_show_range &&
        !check_named(frame->show_range, &RANGES[RANGE_SHOW_CURVATURE], "show_range", text))
        return false;
    if (frame->has_light_share && !(frame->light_share >= 0 && frame->light_share <= 1))
        return check_refuse(text, "light_share is %g; it must be from 0 to 1", frame->light_share);
    if ((frame->has_up && !check_direction(&frame->up, "up", text)) ||
        (frame->has_up_source &&
         !check_enum(frame->up_source, sheen_UpSource_UP_GUESSED, "up_source", text)))
        return false;
    if (!check_extremes(frame, text))
        return false;
    if (!check_colours(frame->has_miss ? &frame->miss : NULL,
                       frame->has_empty ? &frame->empty : NULL,
                       frame->has_base ? &frame->base : NULL, text))
        return false;
    return check_whole_scene(&frame->camera, &frame->lines, frame->lights, frame->lights_count,
                             text) &&
           check_text(frame->device, "device", text) && check_text(frame->driver, "driver", text) &&
           check_text(frame->server, "server", text);
}

static bool check_model_info(const sheen_ModelInfo *info, char *text)
{
    if (!message_is_text(info->warnings, true))
        return check_refuse(text, "warnings are not lines of UTF-8 text");
    for (pb_size_t i = 0; i < info->findings_count; i++)
        if (info->findings[i].count == 0 ||
            (info->findings[i].has_line && info->findings[i].line == 0))
            return check_refuse(text, "findings[%u] is of nothing, or on line 0", (unsigned)i);
    return check_text(info->name, "name", text) && check_vec3(&info->box_min, "box_min", text) &&
           check_vec3(&info->box_max, "box_max", text);
}

bool message_check_answer(uint8_t type, const void *body, char text[static MESSAGE_TEXT_BYTES])
{
    switch (type) {
    case MESSAGE_HELLO_OK: {
        const sheen_HelloOk *ok = body;
        if (ok->credits == 0 || ok->credits > PROTOCOL_MAX_CREDITS)
            return check_refuse(text, "credits is %u; it must be from 1 to %u", ok->credits,
                                PROTOCOL_MAX_CREDITS);
        return check_text(ok->server, "server", text) && check_text(ok->device, "device", text) &&
               check_text(ok->driver, "driver", text);
    }
    case MESSAGE_UPLOAD_STATE:
        return true;
    case MESSAGE_SUPERSEDED:
        return ((const sheen_Superseded *)body)->by != 0 ||
               check_refuse(text, "by is 0, which is no request's number");
    case MESSAGE_MODEL_INFO:
        return check_model_info(body, text);
    case MESSAGE_FRAME:
        return check_frame(body, text);
    case MESSAGE_BREAKS:
        return check_breaks(body, text);
    case MESSAGE_COMPARED:
        return check_compared(body, text);
    case MESSAGE_CURVES:
        return check_curves(body, text);
    case MESSAGE_PROGRESS:
        return check_text(((const sheen_Progress *)body)->stage, "stage", text);
    case MESSAGE_STATS: {
        const sheen_Stats *stats = body;
        return check_text(stats->server, "server", text) &&
               check_text(stats->device, "device", text) &&
               check_text(stats->driver, "driver", text);
    }
    case MESSAGE_ERROR: {
        const sheen_Error *error = body;
        if (error->code == sheen_ErrorCode_ERROR_NONE)
            return check_refuse(text, "code is 0; an error has one");
        return check_enum(error->code, sheen_ErrorCode_ERROR_GPU_LOST, "code", text) &&
               check_text(error->text, "text", text);
    }
    default:
        return check_refuse(text, "a server sends no %s", message_type_name(type));
    }
}
