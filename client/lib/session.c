#include "client/lib/session.h"

#include "client/lib/status.h"

#define LAST_WORDS_MS 1000

enum sheen_status session_fail(struct sheen_session *session, enum sheen_status status,
                               struct sheen_error *error)
{
    if (!sheen_status_is_fatal(status))
        return status;
    session->broken = true;
    if (status == SHEEN_LOST_SERVER)
        return private_daemon_explain(&session->daemon, status, error);
    return status;
}

size_t session_find_pending(const struct sheen_session *session, uint32_t seq)
{
    size_t i = 0;
    while (i < session->n_pending && session->pending[i].seq != seq)
        i++;
    return i;
}

enum sheen_status session_check(const struct sheen_session *session, struct sheen_error *error)
{
    if (!session)
        return status_set(error, SHEEN_BAD_ARGUMENT, "session is NULL");
    if (session->broken)
        return status_set(error, SHEEN_LOST_SERVER, "this session has failed: connect again");
    return SHEEN_OK;
}

enum sheen_status session_bad_peer(struct sheen_session *session, struct sheen_error *error,
                                   uint8_t type, const char *what)
{
    status_set(error, SHEEN_BAD_PEER, "the server broke the protocol: %s: %s",
               message_type_name(type), what);
    return session_fail(session, SHEEN_BAD_PEER, error);
}

/* Reads the rest of the current header or body, n_bytes in all. */
static enum sheen_status fill(struct sheen_session *session, uint8_t *bytes, size_t n_bytes,
                              struct sheen_error *error)
{
    struct session_input *input = &session->input;
    enum sheen_status status =
        connection_read(&session->connection, bytes, n_bytes, &input->n_got, error);
    if (status)
        return status == SHEEN_AGAIN ? status : session_fail(session, status, error);
    input->n_got = 0;
    return SHEEN_OK;
}

static enum sheen_status read_header(struct sheen_session *session, struct message_header *header,
                                     struct sheen_error *error)
{
    struct session_input *input = &session->input;
    if (!input->has_header) {
        enum sheen_status status = fill(session, input->head, sizeof(input->head), error);
        if (status)
            return status;
        input->header = (struct message_header){0};
        enum header_error wrong = message_header_decode(&input->header, input->head);
        if (wrong == HEADER_BAD_MAJOR) {
            status_set(error, SHEEN_BAD_VERSION,
                       "the server speaks version %u of the protocol, this client version %u; "
                       "install the same version of sheen on both sides",
                       (unsigned)input->header.major, (unsigned)PROTOCOL_MAJOR);
            return session_fail(session, SHEEN_BAD_VERSION, error);
        }
        if (wrong != HEADER_OK)
            return session_bad_peer(session, error, input->header.type, header_error_text(wrong));
        input->has_header = true;
    }
    *header = input->header;
    return SHEEN_OK;
}

enum sheen_status session_read_raw(struct sheen_session *session,
                                   const struct message_header *header, uint8_t *bytes,
                                   struct sheen_error *error)
{
    enum sheen_status status = fill(session, bytes, header->length, error);
    if (!status)
        session->input.has_header = false;
    return status;
}

enum sheen_status session_read_body(struct sheen_session *session,
                                    const struct message_header *header, void *body,
                                    struct sheen_error *error)
{
    char text[MESSAGE_TEXT_BYTES];
    uint8_t *bytes = session->input.body;
    if (header->length > sizeof(session->input.body))
        return session_bad_peer(session, error, header->type, "its body is too long");
    enum sheen_status status = session_read_raw(session, header, bytes, error);
    if (status)
        return status;
    if (!message_decode(header->type, bytes, header->length, body)) {
        message_find_fault(header->type, bytes, header->length, text);
        return session_bad_peer(session, error, header->type, text);
    }
    if (!message_check_answer(header->type, body, text))
        return session_bad_peer(session, error, header->type, text);
    return SHEEN_OK;
}

static enum sheen_status status_of_code(sheen_ErrorCode code)
{
    switch (code) {
    case sheen_ErrorCode_ERROR_VERSION:
        return SHEEN_BAD_VERSION;
    case sheen_ErrorCode_ERROR_REQUEST:
        return SHEEN_BAD_REQUEST;
    case sheen_ErrorCode_ERROR_MODEL:
        return SHEEN_BAD_MODEL;
    case sheen_ErrorCode_ERROR_IMAGE:
        return SHEEN_BAD_IMAGE;
    case sheen_ErrorCode_ERROR_UNKNOWN_MODEL:
        return SHEEN_UNKNOWN_MODEL;
    case sheen_ErrorCode_ERROR_TOO_BIG:
        return SHEEN_TOO_BIG;
    case sheen_ErrorCode_ERROR_OVERLOADED:
        return SHEEN_OVERLOADED;
    case sheen_ErrorCode_ERROR_SHUTTING_DOWN:
        return SHEEN_SHUTTING_DOWN;
    case sheen_ErrorCode_ERROR_DEVICE:
        return SHEEN_DEVICE_FAILED;
    case sheen_ErrorCode_ERROR_CANCELLED:
        return SHEEN_CANCELLED;
    case sheen_ErrorCode_ERROR_DEADLINE:
        return SHEEN_LATE;
    case sheen_ErrorCode_ERROR_GPU_LOST:
        return SHEEN_GPU_LOST;
    default:
        return SHEEN_BAD_PEER;
    }
}

enum sheen_status session_read_error(struct sheen_session *session,
                                     const struct message_header *header, struct sheen_error *error)
{
    sheen_Error body;
    enum sheen_status status = session_read_body(session, header, &body, error);
    if (status)
        return status;
    status = status_of_code(body.code);
    status_set(error, status, "%s", body.text);
    return session_fail(session, status, error);
}

/* A write has failed. If the server sent an error before it closed, that text is better. */
static enum sheen_status last_words(struct sheen_session *session, enum sheen_status status,
                                    struct sheen_error *error)
{
    struct message_header header;
    struct sheen_error words;
    if (status != SHEEN_LOST_SERVER)
        return session_fail(session, status, error);
    session->broken = true;
    session->connection.timeout_ms = LAST_WORDS_MS;
    session->connection.must_not_wait = false;
    enum sheen_status said;
    do {
        said = read_header(session, &header, &words);
        if (!said && header.type != MESSAGE_ERROR)
            return session_fail(session, status, error);
        if (!said)
            said = session_read_error(session, &header, &words);
    } while (!sheen_status_is_fatal(said) && said != SHEEN_DEVICE_FAILED);
    if (said == SHEEN_TIMEOUT)
        return session_fail(session, status, error);
    return status_set(error, said, "%s", words.text);
}

enum sheen_status session_send(struct sheen_session *session, uint8_t type, const void *body,
                               uint32_t *seq, struct sheen_error *error)
{
    if (++session->last_seq == 0)
        session->last_seq = 1; /* no request has number 0 */
    *seq = session->last_seq;
    return session_send_again(session, type, body, *seq, error);
}

enum sheen_status session_send_again(struct sheen_session *session, uint8_t type, const void *body,
                                     uint32_t seq, struct sheen_error *error)
{
    size_t length = 0;
    if (!message_encode(type, seq, body, session->output, sizeof(session->output), &length))
        return status_set(error, SHEEN_BAD_ARGUMENT, "a text of the %s is too long",
                          message_type_name(type));
    enum sheen_status status =
        connection_write(&session->connection, session->output, length, error);
    return status ? last_words(session, status, error) : SHEEN_OK;
}

enum sheen_status session_send_raw(struct sheen_session *session, uint8_t type, uint32_t seq,
                                   const uint8_t *bytes, uint32_t n_bytes,
                                   struct sheen_error *error)
{
    uint8_t head[MESSAGE_HEADER_BYTES];
    message_header_encode(
        &(struct message_header){
            .major = PROTOCOL_MAJOR, .type = type, .length = n_bytes, .seq = seq},
        head);
    enum sheen_status status = connection_write(&session->connection, head, sizeof(head), error);
    if (!status)
        status = connection_write(&session->connection, bytes, n_bytes, error);
    return status ? last_words(session, status, error) : SHEEN_OK;
}

static enum sheen_status read_progress(struct sheen_session *session,
                                       const struct message_header *header,
                                       const struct sheen_progress *progress,
                                       struct sheen_error *error)
{
    sheen_Progress body;
    enum sheen_status status = session_read_body(session, header, &body, error);
    if (!status && progress && progress->report)
        progress->report(progress->context, body.stage, body.done, body.total);
    return status;
}

enum sheen_status session_next(struct sheen_session *session, const struct sheen_progress *progress,
                               struct message_header *header, struct sheen_error *error)
{
    enum sheen_status status;
    do {
        status = read_header(session, header, error);
        if (!status && header->type == MESSAGE_PROGRESS)
            status = read_progress(session, header, progress, error);
    } while (!status && header->type == MESSAGE_PROGRESS);
    return status;
}

enum sheen_status session_expect(struct sheen_session *session, uint32_t seq, uint8_t type,
                                 const struct sheen_progress *progress,
                                 struct message_header *header, struct sheen_error *error)
{
    enum sheen_status status = session_next(session, progress, header, error);
    if (status)
        return status;
    if (header->type == MESSAGE_ERROR && (header->seq == seq || header->seq == 0))
        return session_read_error(session, header, error);
    if (header->seq != seq)
        return session_bad_peer(session, error, header->type, "it answers no request in flight");
    if (header->type != type)
        return session_bad_peer(session, error, header->type, "another answer was due");
    return SHEEN_OK;
}

enum sheen_status session_receive(struct sheen_session *session, uint32_t seq, uint8_t type,
                                  const struct sheen_progress *progress, void *body,
                                  struct sheen_error *error)
{
    struct message_header header;
    enum sheen_status status = session_expect(session, seq, type, progress, &header, error);
    return status ? status : session_read_body(session, &header, body, error);
}
