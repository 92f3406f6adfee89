#include "server/frame/request.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/base/hex.h"
#include "server/frame/compute.h"
#include "server/frame/error_code.h"
#include "server/frame/request_internal.h"

enum request_class request_class_of(sheen_RequestClass request_class)
{
    return request_class == sheen_RequestClass_CLASS_INTERACTIVE ? CLASS_INTERACTIVE
           : request_class == sheen_RequestClass_CLASS_BATCH     ? CLASS_BATCH
                                                                 : CLASS_STILL;
}

void request_client_join(struct request_client *client, struct party *party)
{
    client->party = party;
    scheduler_add_queue(&client->queue, &party->schedule);
    LIST_INIT(&client->requests);
}

static struct request *request_create(struct request_client *client, struct reply *reply,
                                      uint32_t seq)
{
    struct request *request = block_cache_take(client->host->block_cache, sizeof *request);
    if (!request) {
        client->events->refused(client->owner, reply, sheen_ErrorCode_ERROR_OVERLOADED,
                                "no memory for another request: try again later");
        return NULL;
    }
    *request = (struct request){.host = client->host, .state = REQUEST_LOADING};
    request->client = client;
    request->party = party_reference(client->party);
    request->reply = reply;
    request->seq = seq;
    memcpy(request->assets_of, client->assets_of, sizeof request->assets_of);
    memcpy(request->asker, client->identity, sizeof request->asker);
    request->start_us = clock_now_us();
    atomic_init(&request->abandoned, false);
    LIST_INSERT_HEAD(&client->requests, request, client_link);
    return request;
}

static void leave_client(struct request *request)
{
    if (!request->client)
        return;
    LIST_REMOVE(request, client_link);
    request->client = NULL;
}

static void refuse(struct request *request, sheen_ErrorCode code, const char *text)
{
    const struct request_client *client = request->client;
    client->events->refused(client->owner, request->reply, code, text);
}

void request_end(struct request *request)
{
    leave_client(request);
    if (request->state == REQUEST_PARKED || request->state == REQUEST_PROGRAMS)
        LIST_REMOVE(request, parked_link);
    request_state_move(&request->state, REQUEST_ENDED);
    scheduler_finished(&request->host->scheduler, &request->entry);
    if (request->compute && request->compute->second.asset)
        store_unuse(request->compute->second.asset);
    compute_destroy(request->compute);
    party_put(request->party);
    request_drop_frame(request);
    if (request->model.asset)
        store_unuse(request->model.asset);
    for (int i = 0; i < MAX_LIGHTS; i++)
        if (request->images[i].asset)
            store_unuse(request->images[i].asset);
    block_cache_give(request->host->block_cache, request);
}

void request_fail(struct request *request, const struct error *error)
{
    if (request->client)
        refuse(request, error_code_of(error->kind), error->text);
    request_end(request);
}

static void stop_waiting(struct request *request, struct needed *needed)
{
    if (!store_stop_waiting(&needed->waiter))
        return;
    needed->asset = NULL;
    request->n_awaited--;
}

/* Removes the client from the request. The request continues if another thread works for it. It
 * stops waiting for builds, which may take minutes: a client that asks and cancels again and again
 * must not leave more and more requests behind. */
static void abandon(struct request *request)
{
    atomic_store(&request->abandoned, true);
    leave_client(request);
    stop_waiting(request, &request->model);
    for (int i = 0; i < MAX_LIGHTS; i++)
        stop_waiting(request, &request->images[i]);
    scheduler_leave(&request->host->scheduler, &request->entry);
    bool is_busy = request_state_is_busy(request->state);
    if (request->compute) {
        stop_waiting(request, &request->compute->second);
        compute_stop(request->compute);
        is_busy = compute_is_running(request->compute);
    }
    if (request->n_awaited > 0 || is_busy)
        request_state_move(&request->state, REQUEST_ABANDONED);
    else
        request_end(request);
}

/* --- replies before their time */

void request_reply_superseded(struct request *request, uint32_t by_seq)
{
    const sheen_Superseded superseded = {.by = by_seq};
    const struct request_client *client = request->client;
    client->events->answered(client->owner, request->reply, MESSAGE_SUPERSEDED, &superseded);
    abandon(request);
}

static void refuse_early(struct request *request, sheen_ErrorCode code, const char *text)
{
    refuse(request, code, text);
    abandon(request);
}

void request_cancel(struct request_client *client, uint32_t seq)
{
    struct request *request;
    LIST_FOREACH (request, &client->requests, client_link) {
        if (request->seq != seq)
            continue;
        refuse_early(request, sheen_ErrorCode_ERROR_CANCELLED, "the request was taken back");
        return;
    }
}

void request_cancel_all(struct request_client *client)
{
    while (!LIST_EMPTY(&client->requests))
        refuse_early(LIST_FIRST(&client->requests), sheen_ErrorCode_ERROR_CANCELLED,
                     "the connection ends: it has asked for more than its credits");
}

void request_shut_down_all(struct request_client *client, uint64_t drain_s)
{
    char text[MESSAGE_TEXT_BYTES];
    snprintf(text, sizeof text,
             "not done within the %llu s (drain-timeout) that the daemon takes to shut down: ask "
             "another or the next",
             (unsigned long long)drain_s);
    while (!LIST_EMPTY(&client->requests))
        refuse_early(LIST_FIRST(&client->requests), sheen_ErrorCode_ERROR_SHUTTING_DOWN, text);
}

bool request_is_late(const struct request *request, uint64_t now_us)
{
    return request->deadline_us > 0 && now_us > request->deadline_us;
}

void request_reply_late(struct request *request)
{
    char text[MESSAGE_TEXT_BYTES];
    snprintf(text, sizeof text, "not %s within its deadline_ms of %u",
             request->compute ? "done" : "drawn", request->render.deadline_ms);
    refuse_early(request, sheen_ErrorCode_ERROR_DEADLINE, text);
}

/* Frames that have begun to be drawn are sent even if they are late. */
void request_end_late(struct request_client *client, uint64_t now_us)
{
    struct request *request = LIST_FIRST(&client->requests);
    while (request) {
        struct request *next = LIST_NEXT(request, client_link);
        if (request->entry.state < SCHEDULE_DRAWING && request_is_late(request, now_us))
            request_reply_late(request);
        request = next;
    }
}

/* --- what it needs from the store */

static void assets_ready(struct request *request);

void request_stop_awaiting(struct request *request)
{
    if (--request->n_awaited == 0)
        assets_ready(request);
}

static void asset_ready(struct asset_waiter *waiter, const struct error *failure)
{
    struct needed *needed = waiter->owner;
    if (failure) {
        needed->asset = NULL;
        needed->request->failure = *failure;
    }
    request_stop_awaiting(needed->request);
}

void request_acquire(struct request *request, struct needed *needed, enum asset_kind kind,
                     const uint8_t *sha256)
{
    needed->request = request;
    needed->waiter = (struct asset_waiter){.ready = asset_ready, .owner = needed};
    needed->asset =
        store_find(request->host->store, request->assets_of, request->asker, kind, sha256);
    request->n_awaited++;
    if (!needed->asset) { /* evicted when room was made for another asset of this request */
        error_set(&request->failure, ERROR_SERVER,
                  "the model or an image of this frame had to make room: try again later");
        request_stop_awaiting(request);
        return;
    }
    switch (store_acquire(needed->asset, request->asker, &needed->waiter, &request->failure)) {
    case ACQUIRE_WAIT:
        return;
    case ACQUIRE_FAILED:
        needed->asset = NULL;
        break;
    case ACQUIRE_READY:
        break;
    }
    request_stop_awaiting(request);
}

/* Answers and returns false if the store does not have the file. */
static bool is_known(struct request *request, enum asset_kind kind, const uint8_t *sha256)
{
    if (store_find(request->host->store, request->assets_of, request->asker, kind, sha256))
        return true;
    char hex[2 * MODEL_ID_BYTES + 1], text[160];
    hex_write(sha256, MODEL_ID_BYTES, hex);
    snprintf(text, sizeof text, "no %s with SHA-256 %s here: upload it first",
             kind == ASSET_MODEL ? "model" : "image", hex);
    refuse(request, sheen_ErrorCode_ERROR_UNKNOWN_MODEL, text);
    request_end(request);
    return false;
}

/* --- what is asked for */

void request_query(struct request_client *client, struct reply *reply, uint32_t seq,
                   const sheen_ModelQuery *query)
{
    struct request *request = request_create(client, reply, seq);
    if (!request || (!query->has_file && !is_known(request, ASSET_MODEL, query->sha256)))
        return;
    request->is_query = true;
    request->n_awaited = 1; /* until all is asked for */
    if (query->has_file)
        request_load_file(request, query->file);
    else
        request_acquire(request, &request->model, ASSET_MODEL, query->sha256);
    request_stop_awaiting(request);
}

/* A party may replace 2,000 requests a second, and 100 more at once: enough for a hand that moves with 1,000
 * events a second in two windows. */
enum { REPLACED_US = 500 };

/* Puts the frame into the scheduler's queue. From here on a newer request of its view replaces
 * it. */
static void enter_queue(struct request *request)
{
    struct schedule_entry *entry = &request->entry;
    const sheen_Render *render = &request->render;
    entry->owner = request;
    entry->request_class = request_class_of(render->request_class);
    entry->has_view = render->has_view || entry->request_class == CLASS_INTERACTIVE;
    entry->view = render->view;
    struct schedule_entry *replaced =
        scheduler_enter(&request->host->scheduler, &request->client->queue, entry);
    if (replaced) {
        request_reply_superseded(replaced->owner, request->seq);
        intake_postpone(&request->party->intake, clock_now_us(), REPLACED_US);
    }
}

/* True if the frame's file is written by the worker program for images. */
static bool takes_images(const sheen_Render *render)
{
    return render->encoding == sheen_Encoding_ENCODING_EXR ||
           render->encoding == sheen_Encoding_ENCODING_TIFF;
}

void request_render(struct request_client *client, struct reply *reply, uint32_t seq,
                    const sheen_Render *render, uint64_t frame_bytes)
{
    struct request *request = request_create(client, reply, seq);
    if (!request)
        return;
    if (!is_known(request, ASSET_MODEL, render->model_sha256))
        return;
    for (pb_size_t i = 0; i < render->lights_count; i++)
        if (render->lights[i].pattern.has_image_sha256 &&
            !is_known(request, ASSET_IMAGE, render->lights[i].pattern.image_sha256))
            return;
    request->render = *render;
    request->frame_bytes = frame_bytes;
    if (takes_images(render))
        workers_expect_images(request->host->workers);
    if (render->has_deadline_ms)
        request->deadline_us = request->start_us + render->deadline_ms * 1000ull;
    enter_queue(request);
    request->n_awaited = 1; /* until all is asked for */
    request_acquire(request, &request->model, ASSET_MODEL, render->model_sha256);
    for (pb_size_t i = 0; i < render->lights_count; i++)
        if (render->lights[i].pattern.has_image_sha256)
            request_acquire(request, &request->images[i], ASSET_IMAGE,
                            render->lights[i].pattern.image_sha256);
    request_stop_awaiting(request);
}

void request_compute(struct request_client *client, struct reply *reply, uint32_t seq, uint8_t type,
                     const union compute_asked *asked)
{
    struct request *request = request_create(client, reply, seq);
    if (!request)
        return;
    struct compute *compute = request->compute = compute_create(request, type, asked);
    if (!compute) {
        error_set(&request->failure, ERROR_SERVER,
                  "no memory for another request: try again later");
        request_fail(request, &request->failure);
        return;
    }
    const uint8_t *second = compute->kind->second ? compute->kind->second(asked) : NULL;
    request->render = *compute->kind->scene(asked);
    if (!is_known(request, ASSET_MODEL, request->render.model_sha256) ||
        (second && !is_known(request, ASSET_MODEL, second)))
        return;
    if (request->render.has_deadline_ms)
        request->deadline_us = request->start_us + request->render.deadline_ms * 1000ull;
    request->n_awaited = 1; /* until all is asked for */
    request_acquire(request, &request->model, ASSET_MODEL, request->render.model_sha256);
    if (second)
        request_acquire(request, &compute->second, ASSET_MODEL, second);
    request_stop_awaiting(request);
}

static void assets_ready(struct request *request)
{
    if (request->failure.kind != ERROR_NONE)
        request_fail(request, &request->failure);
    else if (!request->client)
        request_end(request);
    else if (request->is_query)
        request_reply_query(request);
    else if (request->compute)
        compute_enter_line(request->compute);
    else
        request_queue_frame(request);
}

/* --- for the client */

void request_client_finish(struct request_client *client)
{
    while (!LIST_EMPTY(&client->requests))
        abandon(LIST_FIRST(&client->requests));
}

/* What the request waits for: builds of its models, then its own computation. False: nothing that is measured. */
static bool find_progress(const struct request *request, sheen_Progress *progress)
{
    const struct asset *const models[2] = {
        request->model.asset, request->compute ? request->compute->second.asset : NULL};
    for (int i = 0; i < 2; i++) {
        const struct asset *asset = models[i];
        if (!asset || asset->state != ASSET_BUILDING)
            continue;
        *progress = (sheen_Progress){.done = atomic_load(&asset->progress.done),
                                     .total = asset->progress.total};
        snprintf(progress->stage, sizeof progress->stage, "%s", asset->progress.stage);
        return true;
    }
    return request->compute && compute_progress(request->compute, progress);
}

void request_report_progress(struct request_client *client)
{
    const struct request *request;
    sheen_Progress progress;
    LIST_FOREACH (request, &client->requests, client_link)
        if (find_progress(request, &progress))
            client->events->progressed(client->owner, request->reply, &progress);
}
