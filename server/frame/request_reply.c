/* How a frame that has been drawn is encoded, held back and answered. */
#include <stdio.h>

#include "protocol/messages/message_values.h"
#include "server/base/clock.h"
#include "server/frame/request.h"
#include "server/frame/request_internal.h"
#include "server/scene/scene_convert.h"

static void fill_frame(const struct request *request, const struct encoded *encoded,
                       sheen_Frame *frame)
{
    const struct frame_request *asked = &request->frame_request;
    const struct renderer_info *info = render_thread_info(request->host->render_thread);
    *frame = (sheen_Frame){
        .width_px = asked->width_px,
        .height_px = asked->height_px,
        .planes = request->render.planes,
        .encoding = request->render.encoding,
        .data_bytes = encoded->size,
        .times = request->times,
        .camera = scene_write_camera(&asked->camera),
        .lights_count = (pb_size_t)asked->n_lights,
        .lines = scene_write_lines(&asked->lines),
        .software = info->software,
        .has_show_range = request->render.show.has_range,
        .show_range = request->render.show.range,
        .has_blank = request->is_blank,
        .blank = request->is_blank,
        .has_light_share = request->has_light_share,
        .light_share = request->light_share,
        .has_up = true,
        .up = message_vec3(request->up),
        .has_up_source = true,
        .up_source = request->up_source,
        .has_miss = true,
        .miss = message_colour(asked->miss),
        .has_empty = true,
        .empty = message_colour(asked->empty),
        .has_base = true,
        .base = message_colour(asked->base),
        .has_threads = info->n_threads > 0,
        .threads = info->n_threads,
        .has_show_least = request->extremes.has_values,
        .show_least = request->extremes.least,
        .has_show_greatest = request->extremes.has_values,
        .show_greatest = request->extremes.greatest,
    };
    for (uint32_t i = 0; i < asked->n_lights; i++)
        frame->lights[i] =
            scene_write_light(&asked->lights[i],
                              i < request->render.lights_count ? &request->render.lights[i] : NULL);
    snprintf(frame->device, sizeof frame->device, "%s", info->device);
    snprintf(frame->driver, sizeof frame->driver, "%s", info->driver);
    snprintf(frame->server, sizeof frame->server, "%s", SHEEN_VERSION);
}

static void reply_frame(struct request *request, struct encoded *encoded)
{
    request->times.tables_us = request->model.asset->unreported_us;
    request->times.total_us = clock_now_us() - request->start_us;
    request->model.asset->unreported_us = 0;
    sheen_Frame frame;
    fill_frame(request, encoded, &frame);
    const struct request_client *client = request->client;
    client->events->drawn(client->owner, request->reply, request->entry.request_class, &frame,
                          encoded);
    request_end(request);
}

void request_hand_over_charge(struct request *request, struct encoded *encoded)
{
    memory_charge_shrink(request->charge, encoded->size);
    encoded->released = memory_charge_release;
    encoded->memory_of = request->charge;
    request->charge = NULL;
}

/* Holds a frame back while an earlier interactive frame is being sent. If a newer one was
 * requested, this one is superseded. */
static void hold(struct request *request, struct encoded *encoded)
{
    request_state_move(&request->state, REQUEST_HELD);
    request->held = encoded;
    const struct schedule_entry *newer = scheduler_hold(&request->entry);
    if (newer)
        request_reply_superseded(request, ((const struct request *)newer->owner)->seq);
}

void request_send_held(struct request_client *client)
{
    const struct schedule_entry *entry;
    if (client->queue.n_held ==
        0) /* nearly always, and this is asked of all clients after each event */
        return;
    TAILQ_FOREACH (entry, &client->queue.entries, link) {
        struct request *request = entry->owner;
        if (entry->state != SCHEDULE_HELD)
            continue;
        struct encoded *encoded = request->held;
        request->held = NULL;
        reply_frame(request, encoded);
        return;
    }
}

static void encode_finished(void *owner, struct encoded *encoded, const struct error *error)
{
    struct request *request = owner;
    request->times.encode_us = clock_now_us() - request->encode_start_us;
    if (error) {
        request_fail(request, error);
        return;
    }
    request_hand_over_charge(request, encoded);
    const struct request_client *client = request->client;
    bool interactive = request->entry.request_class == CLASS_INTERACTIVE;
    if (request->state == REQUEST_ABANDONED) {
        encoded_destroy(encoded);
        request_end(request);
    } else if (interactive && client->events->is_sending(client->owner)) {
        hold(request, encoded);
    } else {
        reply_frame(request, encoded);
    }
}

void request_start_encoding(struct request *request)
{
    request_state_move(&request->state, REQUEST_ENCODING);
    metadata_init(&request->metadata, &request->frame_request, &request->render,
                  render_thread_info(request->host->render_thread));
    const struct encode_format format = encode_format_of(&request->render);
    encode_start(request->host->pool, request->host->workers, &request->frame, &request->layout,
                 &format, request_urgency(request), request->metadata.attributes,
                 METADATA_ATTRIBUTES, encode_finished, request);
}
