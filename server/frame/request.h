/* A request that takes time: a model's description or a frame. It waits for what it needs from the
 * store, for memory, for its turn, for the GL thread and for the encoder, and then answers its
 * session.
 *
 * A request owns itself: it ends after its reply, or, when it is answered before (replaced,
 * cancelled, late) or its session has gone, as soon as no other thread works for it. Thread: the
 * loop's. */
#ifndef SHEEN_FRAME_REQUEST_H
#define SHEEN_FRAME_REQUEST_H

#include "server/session/session.h"

struct request;

/* The class of a message's number. */
enum request_class request_class_of(sheen_RequestClass request_class);

/* What the device keeps for a frame that is drawn in parts, while others are drawn: 0 but for
 * polygons. `render` has passed message_check_render(). */
uint64_t request_paused_bytes(const struct session_host *host, const sheen_Render *render);

/* Both fill `answer` in the end, unless the session goes; they may have ended when they return. */
void request_query(struct session *session, struct reply *reply, uint32_t seq,
                   const sheen_ModelQuery *query);
/* `render` has passed message_check_render(); its frame takes so many bytes of the budget, which
 * allows them. */
void request_render(struct session *session, struct reply *reply, uint32_t seq,
                    const sheen_Render *render, uint64_t frame_bytes);

/* Answers the request of this number ERROR_CANCELLED, if it has not been answered. */
void request_cancel(struct session *session, uint32_t seq);
/* The same for all of the session's. */
void request_cancel_all(struct session *session);
/* Answers all of the session's ERROR_SHUTTING_DOWN: the daemon's time to finish them is over. */
void request_shut_down_all(struct session *session);
/* Answers those whose time is over ERROR_DEADLINE. */
void request_end_late(struct session *session, uint64_t now_us);
/* The session's socket has taken its interactive frame: the next that is ready goes. */
void request_send_held(struct session *session);

/* Starts what the scheduler says is next, until it says nothing. */
void request_start_next(struct session_host *host);

/* The session goes away: lets go of all its requests. */
void request_abandon_all(struct session *session);

/* Sends PROGRESS for what waits for a build. */
void request_report_progress(struct session *session);

#endif
