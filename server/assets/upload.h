/* One file on its way from a client into the store. Thread: the loop's. */
#ifndef SHEEN_ASSETS_UPLOAD_H
#define SHEEN_ASSETS_UPLOAD_H

#include "protocol/message.h"
#include "server/assets/memory.h"

struct upload;

enum upload_state {
    UPLOAD_MORE,     /* wants more bytes */
    UPLOAD_STORED,   /* complete, its hash is right, the store has it */
    UPLOAD_BAD,      /* complete, its hash is wrong */
    UPLOAD_TOO_MUCH, /* more bytes than were announced */
    UPLOAD_NO_ROOM,  /* more than memory, the budget or the peer's part of it has room for */
};

/* Nothing is charged yet: what has come counts, not what is announced. In the end the file is the
 * owner's, or everybody's if begin->share; it counts for `holder` (store_add). `begin` has passed
 * message_check_upload_begin(); `quota` stays as long as the upload. */
struct upload *upload_create(struct memory *memory, struct client_quota *quota,
                             const uint8_t owner[static OWNER_BYTES],
                             const uint8_t holder[static OWNER_BYTES],
                             const sheen_UploadBegin *begin, struct error *error);
/* Gives the bytes back, unless the store has them. NULL is safe. */
void upload_destroy(struct upload *upload);

/* After anything but UPLOAD_MORE the upload can only be destroyed. *error says why it was bad. */
enum upload_state upload_add(struct upload *upload, const uint8_t *bytes, size_t size,
                             struct error *error);
uint64_t upload_received_bytes(const struct upload *upload);

#endif
