/* One file on its way from a client into the store. Thread: the loop's. */
#ifndef SHEEN_SERVICE_UPLOAD_H
#define SHEEN_SERVICE_UPLOAD_H

#include "protocol/message.h"
#include "server/service/store.h"

struct upload;

enum upload_state {
    UPLOAD_MORE,     /* wants more bytes */
    UPLOAD_STORED,   /* complete, its hash is right, the store has it */
    UPLOAD_BAD,      /* complete, its hash is wrong */
    UPLOAD_TOO_MUCH, /* more bytes than were announced */
    UPLOAD_NO_ROOM,
};

/* Charges the announced size to the store, where the file will be the owner's, or everybody's if
 * begin->share. `begin` has passed message_check_upload_begin(). */
struct upload *upload_create(struct store *store, const uint8_t owner[static STORE_OWNER_BYTES],
                             const sheen_UploadBegin *begin, struct error *error);
/* Gives the bytes back to the store, unless it has them. NULL is safe. */
void upload_destroy(struct upload *upload);

/* After anything but UPLOAD_MORE the upload can only be destroyed. *error says why it was bad. */
enum upload_state upload_add(struct upload *upload, const uint8_t *bytes, size_t size,
                             struct error *error);
uint64_t upload_received_bytes(const struct upload *upload);

#endif
