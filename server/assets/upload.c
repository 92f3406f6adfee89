#include "server/assets/upload.h"

#include <openssl/evp.h>
#include <stdlib.h>
#include <string.h>

#define FIRST_CAPACITY (256u * 1024)

struct upload {
    struct memory *memory;
    struct client_quota *quota;
    sheen_UploadBegin begin;
    uint8_t owner[OWNER_BYTES], holder[OWNER_BYTES];
    uint8_t *file; /* grows, and is charged, as bytes come: an announcement alone costs nothing */
    size_t received, capacity;
    EVP_MD_CTX *hash;
};

static enum error_kind kind_of_error(const sheen_UploadBegin *begin)
{
    return begin->kind == sheen_UploadKind_UPLOAD_MODEL ? ERROR_MODEL : ERROR_IMAGE;
}

struct upload *upload_create(struct memory *memory, struct client_quota *quota,
                             const uint8_t owner[static OWNER_BYTES],
                             const uint8_t holder[static OWNER_BYTES],
                             const sheen_UploadBegin *begin, struct error *error)
{
    struct upload *upload = calloc(1, sizeof *upload);
    EVP_MD_CTX *hash = EVP_MD_CTX_new();
    if (!upload || !hash || !EVP_DigestInit_ex(hash, EVP_sha256(), NULL)) {
        EVP_MD_CTX_free(hash);
        free(upload);
        error_set(error, ERROR_SERVER, "%s: no memory to receive it", begin->name);
        return NULL;
    }
    upload->memory = memory;
    upload->quota = quota;
    upload->begin = *begin;
    memcpy(upload->owner, begin->share ? STORE_SHARED : owner, sizeof upload->owner);
    memcpy(upload->holder, holder, sizeof upload->holder);
    upload->hash = hash;
    return upload;
}

void upload_destroy(struct upload *upload)
{
    if (!upload)
        return;
    memory_refund_input(upload->quota, upload->capacity);
    EVP_MD_CTX_free(upload->hash);
    free(upload->file);
    free(upload);
}

static bool grow(struct upload *upload, size_t needed, struct error *error)
{
    const sheen_UploadBegin *begin = &upload->begin;
    if (needed <= upload->capacity)
        return true;
    size_t capacity = upload->capacity ? upload->capacity : FIRST_CAPACITY;
    while (capacity < needed)
        capacity *= 2; /* needed is at most PROTOCOL_MAX_UPLOAD_BYTES */
    if (capacity > begin->size_bytes)
        capacity = begin->size_bytes;
    size_t more = capacity - upload->capacity;
    if (!memory_charge_input(upload->memory, upload->quota, upload->holder, more, begin->name,
                             kind_of_error(begin), error))
        return false;
    uint8_t *file = realloc(upload->file, capacity);
    if (!file) {
        memory_refund_input(upload->quota, more);
        return error_set(error, ERROR_SERVER, "%s: no memory for its %llu bytes", begin->name,
                         (unsigned long long)begin->size_bytes);
    }
    upload->file = file;
    upload->capacity = capacity;
    return true;
}

static enum upload_state finish(struct upload *upload, struct error *error)
{
    const sheen_UploadBegin *begin = &upload->begin;
    uint8_t sha256[EVP_MAX_MD_SIZE];
    unsigned size = 0;
    if (!EVP_DigestFinal_ex(upload->hash, sha256, &size) || size != MODEL_ID_BYTES ||
        memcmp(sha256, begin->sha256, MODEL_ID_BYTES) != 0) {
        error_set(error, ERROR_REQUEST,
                  "%s: the bytes received do not have the SHA-256 announced: send it again",
                  begin->name);
        return UPLOAD_BAD;
    }
    uint8_t *file = upload->file;
    upload->capacity = 0; /* the store takes the file and its charge */
    upload->file = NULL;
    enum asset_kind kind = begin->kind == sheen_UploadKind_UPLOAD_MODEL ? ASSET_MODEL : ASSET_IMAGE;
    bool ok = store_add(upload->memory->store, upload->owner, upload->holder, kind, sha256,
                        begin->name, file, upload->received, &upload->quota->account, error);
    return ok ? UPLOAD_STORED : UPLOAD_NO_ROOM;
}

enum upload_state upload_add(struct upload *upload, const uint8_t *bytes, size_t size,
                             struct error *error)
{
    if (size > upload->begin.size_bytes - upload->received) {
        error_set(error, ERROR_REQUEST, "%s: more bytes than the %llu announced",
                  upload->begin.name, (unsigned long long)upload->begin.size_bytes);
        return UPLOAD_TOO_MUCH;
    }
    if (!grow(upload, upload->received + size, error))
        return UPLOAD_NO_ROOM;
    if (!EVP_DigestUpdate(upload->hash, bytes, size)) {
        error_set(error, ERROR_SERVER, "%s: its SHA-256 cannot be computed", upload->begin.name);
        return UPLOAD_BAD;
    }
    if (size > 0)
        memcpy(upload->file + upload->received, bytes, size);
    upload->received += size;
    return upload->received == upload->begin.size_bytes ? finish(upload, error) : UPLOAD_MORE;
}

uint64_t upload_received_bytes(const struct upload *upload)
{
    return upload->received;
}
