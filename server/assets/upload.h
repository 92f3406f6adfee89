/* Receives one file from a client, piece by piece, and puts it into the store.
 * Thread: the loop's. */
#ifndef SHEEN_ASSETS_UPLOAD_H
#define SHEEN_ASSETS_UPLOAD_H

#include "protocol/messages/message.h"
#include "server/assets/memory.h"

struct upload;

enum upload_state {
    UPLOAD_MORE,     /* more bytes are needed */
    UPLOAD_STORED,   /* complete, with the right hash; the store owns the file */
    UPLOAD_BAD,      /* complete, with a wrong hash */
    UPLOAD_TOO_MUCH, /* more bytes than were announced */
    UPLOAD_NO_ROOM,  /* main memory, the memory budget or the identity's quota has no room */
};

/* Starts an upload. Memory is charged as bytes come, not for the announced size. The file will
 * belong to `owner`, or to everybody if begin->share; it counts for `holder` (store_add()). `begin`
 * has passed message_check_upload_begin(); it is copied. `quota` must outlive the upload. NULL with
 * ERROR_SERVER when memory is short. */
struct upload *upload_create(struct memory *memory, struct client_quota *quota,
                             const uint8_t owner[static OWNER_BYTES],
                             const uint8_t holder[static OWNER_BYTES],
                             const sheen_UploadBegin *begin, struct error *error);
/* Frees the bytes, unless the store owns them. NULL is safe. */
void upload_destroy(struct upload *upload);

/* Adds the next bytes. On any failure *error says why. After a result other than UPLOAD_MORE the
 * upload can only be destroyed. */
enum upload_state upload_add(struct upload *upload, const uint8_t *bytes, size_t size,
                             struct error *error);
uint64_t upload_received_bytes(const struct upload *upload);

#endif
