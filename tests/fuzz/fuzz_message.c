/* The body of any message in either direction; the first byte is its type. A body that can be read
 * is written and read again, and must be the same. A body that passes its check must have the
 * properties that the check promises. */
#include <math.h>
#include <string.h>

#include "protocol/codec.h"
#include "protocol/messages/message.h"
#include "tests/fuzz/fuzz.h"

union body {
    sheen_HelloOk hello_ok;
    sheen_UploadBegin upload_begin;
    sheen_UploadState upload_state;
    sheen_ModelQuery model_query;
    sheen_ModelInfo model_info;
    sheen_Render render;
    sheen_Frame frame;
    sheen_Progress progress;
    sheen_Stats stats;
    sheen_Error error;
    sheen_Superseded superseded;
    sheen_FindBreaks find_breaks;
    sheen_Breaks breaks;
    sheen_Compare compare;
    sheen_Compared compared;
    sheen_TraceLines trace_lines;
    sheen_Curves curves;
};

static void check_render(const sheen_Render *render)
{
    char text[MESSAGE_TEXT_BYTES] = "";
    struct codec_layout layout;
    if (!message_check_render(render, 16384, 16384, text)) {
        MUST(message_is_text(text, false) && text[0]);
        return;
    }
    MUST(codec_layout_init(&layout, render->width_px, render->height_px,
                           message_render_planes(render)));
    MUST(!render->has_jpeg_quality || (render->jpeg_quality >= 1 && render->jpeg_quality <= 100));
    MUST(!render->has_jpeg_subsampling ||
         render->jpeg_subsampling <= sheen_JpegSubsampling_JPEG_420);
    if (render->has_window)
        MUST(render->window.x_px >= 0 && render->window.y_px >= 0 &&
             floor(render->window.x_px) + render->width_px <= render->window.width_px &&
             floor(render->window.y_px) + render->height_px <= render->window.height_px);
    if (render->has_camera)
        MUST(isfinite(render->camera.eye.x) && isfinite(render->camera.fov_deg));
}

static void check(uint8_t type, const union body *body)
{
    char text[MESSAGE_TEXT_BYTES] = "";
    if (type == MESSAGE_RENDER)
        check_render(&body->render);
    else if (type == MESSAGE_FIND_BREAKS)
        MUST(message_check_find_breaks(&body->find_breaks, text) || text[0]);
    else if (type == MESSAGE_COMPARE)
        MUST(message_check_compare(&body->compare, text) || text[0]);
    else if (type == MESSAGE_TRACE_LINES)
        MUST(message_check_trace_lines(&body->trace_lines, text) || text[0]);
    else if (type == MESSAGE_UPLOAD_BEGIN)
        MUST(message_check_upload_begin(&body->upload_begin, text) || text[0]);
    else if (type == MESSAGE_MODEL_QUERY)
        MUST(message_check_model_query(&body->model_query, text) || text[0]);
    else
        MUST(message_check_answer(type, body, text) || text[0]);
}

/* The text about a body that breaks the schema must itself fit in an ERROR. */
static void check_fault(uint8_t type, const uint8_t *bytes, size_t size)
{
    char text[MESSAGE_TEXT_BYTES] = "";
    message_find_fault(type, bytes, size, text);
    MUST(text[0] && message_is_text(text, false));
}

static void try_hello(const uint8_t *bytes, size_t size)
{
    uint8_t id[MODEL_ID_BYTES], buffer[MESSAGE_BUFFER_BYTES];
    char text[MESSAGE_TEXT_BYTES] = "";
    sheen_Hello hello;
    size_t length;
    if (!message_hello_decode(bytes, size, id, &hello)) {
        check_fault(MESSAGE_HELLO, bytes, size);
        return;
    }
    MUST(message_check_hello(&hello, text) || text[0]);
    MUST(message_hello_encode(1, id, &hello, buffer, sizeof buffer, &length));
}

void fuzz_one(const uint8_t *bytes, size_t size)
{
    static union body body, again;
    static uint8_t first[MESSAGE_BUFFER_BYTES], second[MESSAGE_BUFFER_BYTES];
    size_t n_first, n_second;
    if (size < 1)
        return;
    uint8_t type = bytes[0];
    if (type == MESSAGE_HELLO) {
        try_hello(bytes + 1, size - 1);
        return;
    }
    if (!message_decode(type, bytes + 1, size - 1, &body)) {
        check_fault(type, bytes + 1, size - 1);
        return;
    }
    check(type, &body);
    MUST(message_encode(type, 1, &body, first, sizeof first, &n_first));
    MUST(
        message_decode(type, first + MESSAGE_HEADER_BYTES, n_first - MESSAGE_HEADER_BYTES, &again));
    MUST(message_encode(type, 1, &again, second, sizeof second, &n_second));
    MUST(n_first == n_second && memcmp(first, second, n_first) == 0);
    MUST(!message_encode(type, 1, &body, first, n_first - 1, &n_second));
}
