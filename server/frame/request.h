/* A request that takes time: a model's description or a frame. It waits for what it needs from the
 * store, for memory, for its turn, for the render thread and for the encoder, and then tells its
 * client's session.
 *
 * A request frees itself after its reply. When it is answered early (replaced, cancelled, late) or
 * its client has gone, it frees itself as soon as no thread and no build works for it any more.
 * request_state.h lists the states of a request. Thread: the loop's. */
#ifndef SHEEN_FRAME_REQUEST_H
#define SHEEN_FRAME_REQUEST_H

#include "server/frame/request_client.h"

/* It is known who the client is, so that it may ask: joins its party. The caller has set all members
 * but `party`, `queue` and `requests`, and holds the references to quota and party. */
void request_client_join(struct request_client *client, struct party *party);
/* The client has gone: gives up all its requests. */
void request_client_finish(struct request_client *client);

/* The class of a message's number. */
enum request_class request_class_of(sheen_RequestClass request_class);

/* What the device keeps for a frame that is drawn in parts, while others are drawn: 0 but for
 * polygons. `render` has passed message_check_render(). */
uint64_t request_paused_bytes(const struct request_host *host, const sheen_Render *render);

/* Both fill `reply` in the end, unless the client goes; they may have ended when they return. */
void request_query(struct request_client *client, struct reply *reply, uint32_t seq,
                   const sheen_ModelQuery *query);
/* `render` has passed message_check_render(); its frame takes so many bytes of the budget, which
 * allows them. */
void request_render(struct request_client *client, struct reply *reply, uint32_t seq,
                    const sheen_Render *render, uint64_t frame_bytes);

/* Answers the request of this number ERROR_CANCELLED, if it has not been answered. */
void request_cancel(struct request_client *client, uint32_t seq);
/* Answers all requests of the client ERROR_CANCELLED. */
void request_cancel_all(struct request_client *client);
/* Answers all of the client's ERROR_SHUTTING_DOWN: the daemon's time to finish them, so many
 * seconds, is over. */
void request_shut_down_all(struct request_client *client, uint64_t drain_s);
/* Answers the client's requests whose deadline has passed ERROR_DEADLINE. */
void request_end_late(struct request_client *client, uint64_t now_us);
/* The client's socket has taken its interactive frame: the next that is ready goes. */
void request_send_held(struct request_client *client);
/* Tells how far the builds are that the client's requests wait for. */
void request_report_progress(struct request_client *client);

/* Starts what the scheduler says is next, until it says nothing. */
void request_start_next(struct request_host *host);

#endif
