#include <stdarg.h>
#include <stdio.h>

#include "server/base/log.h"
#include "server/session/session.h"
#include "server/session/session_internal.h"

void session_log_disconnect(struct session *session, const char *reason)
{
    session->host->stats.disconnected++;
    log_event(LOG_WARN, "client disconnected", log_number("session", session->id),
              log_text("peer", session->client.peer), log_text("text", reason));
}

/* Disconnects a client without a message, because it does not read. The log gets the reason. */
static void __attribute__((format(printf, 2, 3)))
disconnect(struct session *session, const char *format, ...)
{
    char reason[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(reason, sizeof reason, format, arguments);
    va_end(arguments);
    session_log_disconnect(session, reason);
    session->end = session->host->draining ? END_DRAIN : END_UNREAD;
    conn_close(&session->conn);
}

static uint64_t hard_limit(const struct session *session)
{
    const struct session_limits *limits = &session->host->limits;
    return session->output_class == CLASS_INTERACTIVE ? limits->interactive_hard
                                                      : limits->output_hard;
}

bool session_may_send(struct session *session)
{
    if (conn_unsent_bytes(&session->conn) <= hard_limit(session))
        return true;
    disconnect(session,
               "%zu bytes of earlier answers are unsent, over the %s-hard limit of %llu: it does "
               "not read, or not fast enough",
               conn_unsent_bytes(&session->conn),
               session->output_class == CLASS_INTERACTIVE ? "interactive" : "output",
               (unsigned long long)hard_limit(session));
    return false;
}

void session_host_tick(struct session_host *host, uint64_t now_us)
{
    if (host->draining && now_us > host->drain_start_us + host->limits.drain_s * 1000000)
        host->overdue_ticks++;
}

static bool had_last_words(const struct session_host *host)
{
    return host->overdue_ticks > SESSION_LAST_WORDS_TICKS;
}

/* The limit of unsent output that the client exceeds; NULL: none. */
static const char *output_limit(struct session *session, uint64_t now)
{
    const struct session_limits *limits = &session->host->limits;
    bool interactive = session->output_class == CLASS_INTERACTIVE;
    uint64_t unsent = conn_unsent_bytes(&session->conn);
    if (unsent <= (interactive ? limits->interactive_soft : limits->output_soft)) {
        session->over_soft_since_us = 0;
    } else if (session->over_soft_since_us == 0) {
        session->over_soft_since_us = now;
    } else if (now - session->over_soft_since_us >
               (interactive ? limits->interactive_s : limits->output_s) * 1000000) {
        return interactive ? "over interactive-soft for interactive-seconds"
                           : "over output-soft for output-seconds";
    }
    if (unsent > 0 && now - session->conn.last_out_us > limits->stall_s * 1000000)
        return "no byte read for stall-timeout";
    return unsent > 0 && had_last_words(session->host) ? "not read within drain-timeout" : NULL;
}

/* Ends the session of a client that was silent for too long, and tells it the limit. */
static void refuse_late(struct session *session, enum stats_end end, const char *format,
                        uint64_t limit_s)
{
    char text[128];
    snprintf(text, sizeof text, format, (unsigned long long)limit_s);
    session->end = end;
    session_refuse(session, 0,
                   end == END_IDLE ? sheen_ErrorCode_ERROR_SHUTTING_DOWN
                                   : sheen_ErrorCode_ERROR_PROTOCOL,
                   "%s", text);
}

/* Ends a session whose client has not sent something in time, and tells the client. */
static void check_input(struct session *session, uint64_t now)
{
    struct conn *conn = &session->conn;
    const struct session_limits *limits = &session->host->limits;
    uint64_t since_in = now - conn->last_in_us, since_out = now - conn->last_out_us;
    bool is_idle = conn_unsent_bytes(conn) == 0 && session->replies.n == 0;
    uint64_t idle_us = limits->idle_s * 1000000;
    if (session->refused)
        return;
    uint64_t patience_us = limits->handshake_s * 1000000;
    if (session->is_stranger)
        patience_us =
            strangers_patience_us(&session->host->strangers, &limits->strangers, patience_us);
    if (!session->greeted && now - session->start_us > patience_us)
        refuse_late(session, END_HELLO, "no HELLO within %llu s", patience_us / 1000000);
    else if (!conn->held && (conn->in_used > 0 || conn->skipped > 0) &&
             now - conn->message_since_us > limits->message_s * 1000000)
        refuse_late(session, END_STALLED, "a message has not come to its end within %llu s",
                    limits->message_s);
    else if (!conn->held && session->upload && since_in > limits->stall_s * 1000000)
        refuse_late(session, END_STALLED, "an upload stopped in the middle for %llu s",
                    limits->stall_s);
    else if (idle_us > 0 && is_idle && since_in > idle_us && since_out > idle_us)
        refuse_late(session, END_IDLE, "no request for %llu s: connect again when there is one",
                    limits->idle_s);
}

void session_check_limits(struct session *session, uint64_t now)
{
    struct conn *conn = &session->conn;
    const char *limit = output_limit(session, now);
    if (limit)
        disconnect(session, "%zu bytes unsent: %s", conn_unsent_bytes(conn), limit);
    else if (had_last_words(session->host))
        conn_close(conn); /* the client was told, but has not closed its side */
    else if (conn->state == CONN_LINGERING && now - conn->last_in_us > SESSION_LINGER_US)
        conn_close(conn);
    else if (conn->state == CONN_OPEN)
        check_input(session, now);
}
