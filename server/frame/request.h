/* A request that takes time: the description of a model, a frame, or computed numbers. It waits for assets from the
 * store, for memory, for its turn, for the render thread and for the encoder, and then reports the
 * result to its client's session by events (request_client.h). It knows nothing else of sessions.
 *
 * A request owns itself: it is freed after its reply. If it was answered early (superseded,
 * cancelled, late) or its client has gone, it is freed as soon as no thread and no build works for
 * it any more. request_state.h lists the states of a request.
 * Thread: the loop's. */
#ifndef SHEEN_FRAME_REQUEST_H
#define SHEEN_FRAME_REQUEST_H

#include "server/frame/compute_asked.h"
#include "server/frame/request_client.h"

/* Lets an identified client make requests. The caller has set all members except `party`, `queue`
 * and `requests`, and holds references to quota and party until request_client_finish(). */
void request_client_join(struct request_client *client, struct party *party);
/* The client has gone: abandons all its requests. */
void request_client_finish(struct request_client *client);

/* Converts the class of a message; unknown classes are stills. */
enum request_class request_class_of(sheen_RequestClass request_class);

/* The memory in bytes that the device keeps between the tiles of a frame: 0 for the exact surface,
 * which keeps none. `render` has passed message_check_render(). */
uint64_t request_paused_bytes(const struct request_host *host, const sheen_Render *render);
/* The memory in bytes that the device needs to draw the frame on. */
uint64_t request_device_bytes(const struct request_host *host, const sheen_Render *render);

/* Start a request. It answers `reply` later, or before these functions return; if the client goes
 * first, it never does. */
void request_query(struct request_client *client, struct reply *reply, uint32_t seq,
                   const sheen_ModelQuery *query);
/* `render` has passed message_check_render(). frame_bytes is what the frame takes at most; the
 * limits allow it. */
void request_render(struct request_client *client, struct reply *reply, uint32_t seq,
                    const sheen_Render *render, uint64_t frame_bytes);

/* Computes numbers. `type` is that of the message; its body has passed its check. */
void request_compute(struct request_client *client, struct reply *reply, uint32_t seq, uint8_t type,
                     const union compute_asked *asked);

/* Answers the request of this number with ERROR_CANCELLED. Does nothing if it is answered
 * already. */
void request_cancel(struct request_client *client, uint32_t seq);
/* Answers all requests of the client with ERROR_CANCELLED. */
void request_cancel_all(struct request_client *client);
/* Answers all requests of the client with ERROR_SHUTTING_DOWN, because the drain_s seconds to
 * finish them have passed. */
void request_shut_down_all(struct request_client *client, uint64_t drain_s);
/* Answers with ERROR_DEADLINE the client's requests whose deadline has passed before they began to
 * be drawn, or before they were computed. */
void request_end_late(struct request_client *client, uint64_t now_us);
/* Call it when the socket has taken the client's interactive frame: sends the held one, if any. */
void request_send_held(struct request_client *client);
/* Reports the progress of the builds that the client's requests wait for. */
void request_report_progress(struct request_client *client);

/* Starts the tiles that the scheduler chooses, until it chooses none, and computations. */
void request_start_next(struct request_host *host);

#endif
