/* Reads the DATA messages behind an answer. Reading can stop at any byte and continue later.
 * Thread: as the session. */
#ifndef SHEEN_CLIENT_DATA_H
#define SHEEN_CLIENT_DATA_H

#include "client/lib/session.h"

/* Grows a buffer to at least `bytes` bytes and keeps its contents. False when memory is short. */
bool data_reserve(uint8_t **buffer, size_t *capacity, size_t bytes);

/* Reads the rest of `total` bytes that follow the answer to request `seq`. Memory grows with the bytes received, not
 * with the announced size. On failure *data keeps what has come, and the caller frees data->bytes in any case. */
enum sheen_status data_read(struct sheen_session *session, uint32_t seq, size_t total,
                            struct session_data *data, struct sheen_error *error);

#endif
