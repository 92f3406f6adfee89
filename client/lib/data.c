#include "client/lib/data.h"

#include <stdlib.h>

#include "client/lib/status.h"

bool data_reserve(uint8_t **buffer, size_t *capacity, size_t bytes)
{
    if (bytes <= *capacity)
        return true;
    uint8_t *grown = realloc(*buffer, bytes);
    if (!grown)
        return false;
    *buffer = grown;
    *capacity = bytes;
    return true;
}

static enum sheen_status broken(struct sheen_session *session, struct sheen_error *error,
                                const char *what)
{
    status_set(error, SHEEN_BAD_PEER, "the server broke the protocol: %s", what);
    return session_fail(session, SHEEN_BAD_PEER, error);
}

enum sheen_status data_read(struct sheen_session *session, uint32_t seq, size_t total,
                            struct session_data *data, struct sheen_error *error)
{
    while (data->n_received < total) {
        struct message_header header;
        enum sheen_status status = session_expect(session, seq, MESSAGE_DATA, NULL, &header, error);
        if (status)
            return status;
        size_t left = total - data->n_received;
        if (header.length == 0 || header.length > left)
            return broken(session, error, "DATA is longer or shorter than its answer says");
        if ((header.length == left) != ((header.flags & MESSAGE_END) != 0))
            return broken(session, error, "the end of DATA is not where its answer says");
        size_t wanted = data->n_received + header.length;
        if (wanted > data->capacity && wanted < total)
            wanted = 2 * wanted < total ? 2 * wanted : total;
        if (!data_reserve(&data->bytes, &data->capacity, wanted)) {
            status_set(error, SHEEN_NO_MEMORY, "no memory for an answer of %zu bytes", total);
            return session_fail(session, SHEEN_NO_MEMORY, error);
        }
        status = session_read_raw(session, &header, data->bytes + data->n_received, error);
        if (status)
            return status;
        data->n_received += header.length;
    }
    return SHEEN_OK;
}
