/* The order of messages, and memory for long ones. A long message gets memory only when it may come
 * now; all of that memory is charged to --peer-memory and --memory-budget. */
#include "server/session/session_internal.h"
#include "server/frame/error_code.h"

/* From this minor version on the number of an unanswered request must not be used again. */
enum { MINOR_OF_UNIQUE_NUMBERS = 4 };
/* The first minor version with computations. */
enum { MINOR_OF_COMPUTATIONS = 5 };

/* True if the type is a message that asks for a computation. */
static bool asks_computation(uint8_t type)
{
    return type == MESSAGE_FIND_BREAKS || type == MESSAGE_COMPARE || type == MESSAGE_TRACE_LINES;
}

const char *session_find_disorder(const struct session *session,
                                  const struct message_header *header)
{
    if (header->seq == 0)
        return "its number is 0, which is no request's";
    if (!session->greeted)
        return header->type == MESSAGE_HELLO ? NULL : "the first message must be HELLO";
    if (header->type == MESSAGE_HELLO)
        return "a second HELLO";
    if (header->type == MESSAGE_CANCEL)
        return session->minor > 0 ? NULL : "a message of minor version 1";
    if (asks_computation(header->type) && session->minor < MINOR_OF_COMPUTATIONS)
        return "a message of minor version 5";
    if (header->type == MESSAGE_UPLOAD_CHUNK && header->seq != session->upload_seq)
        return "no upload of its number is under way";
    if (session->minor >= MINOR_OF_UNIQUE_NUMBERS && header->type != MESSAGE_UPLOAD_CHUNK &&
        reply_list_owes(&session->replies, header->seq))
        return "its number is that of a request which is not answered yet";
    if (session->upload && header->type != MESSAGE_UPLOAD_CHUNK)
        return "an upload is under way and not complete";
    return NULL;
}

void session_refuse_disorder(struct session *session, const struct message_header *header,
                             const char *disorder)
{
    session_refuse(session, header->seq, sheen_ErrorCode_ERROR_PROTOCOL, "%s: %s",
                   message_type_name(header->type), disorder);
}

bool session_make_room(void *owner, const struct message_header *header, size_t bytes)
{
    struct session *session = owner;
    struct error error = {0};
    const char *disorder = session_find_disorder(session, header);
    if (disorder) {
        session_refuse_disorder(session, header, disorder);
        return false;
    }
    bool is_chunk = header->type == MESSAGE_UPLOAD_CHUNK;
    if (is_chunk && !session->upload)
        return false; /* the upload has failed already */
    size_t more = bytes - CONN_IN_BYTES - session->input_bytes;
    if (memory_charge_input(session->host->memory, session->requests.quota,
                            session->client.identity.owner, more, "a message", ERROR_REQUEST,
                            &error)) {
        session->input_bytes += more;
        return true;
    }
    if (is_chunk) {
        upload_destroy(session->upload);
        session->upload = NULL;
    }
    session_reply_error_now(session, header->seq, error_code_of(error.kind), error.text);
    return false;
}

void session_trim_input(struct session *session)
{
    conn_trim(&session->conn);
    if (session->conn.in_capacity <= CONN_IN_BYTES)
        session_release_input(session);
}

void session_release_input(struct session *session)
{
    if (session->input_bytes == 0)
        return; /* a client that is not admitted has no quota, and no long message */
    memory_refund_input(session->requests.quota, session->input_bytes);
    session->input_bytes = 0;
}
