#include "server/service/upload.h"

#include <openssl/evp.h>
#include <stdlib.h>
#include <string.h>

#define FIRST_CAPACITY (256u * 1024)

struct upload {
    struct store *store;
    sheen_UploadBegin begin;
    uint8_t owner[STORE_OWNER_BYTES];
    uint8_t *file; /* grows as bytes come: announcing costs no memory */
    size_t received, capacity;
    EVP_MD_CTX *hash;
};

struct upload *upload_create(struct store *store, const uint8_t owner[static STORE_OWNER_BYTES],
                             const sheen_UploadBegin *begin, struct error *error)
{
    enum error_kind kind = begin->kind == sheen_UploadKind_UPLOAD_MODEL ? ERROR_MODEL : ERROR_IMAGE;
    if (!store_reserve(store, begin->size_bytes, begin->name, kind, error))
        return NULL;
    struct upload *upload = calloc(1, sizeof *upload);
    EVP_MD_CTX *hash = EVP_MD_CTX_new();
    if (!upload || !hash || !EVP_DigestInit_ex(hash, EVP_sha256(), NULL)) {
        EVP_MD_CTX_free(hash);
        free(upload);
        store_release(store, begin->size_bytes);
        error_set(error, ERROR_SERVER, "%s: no memory to receive it", begin->name);
        return NULL;
    }
    upload->store = store;
    upload->begin = *begin;
    memcpy(upload->owner, begin->share ? STORE_SHARED : owner, sizeof upload->owner);
    upload->hash = hash;
    return upload;
}

void upload_destroy(struct upload *upload)
{
    if (!upload)
        return;
    if (upload->store)
        store_release(upload->store, upload->begin.size_bytes);
    EVP_MD_CTX_free(upload->hash);
    free(upload->file);
    free(upload);
}

static bool grow(struct upload *upload, size_t needed)
{
    if (needed <= upload->capacity)
        return true;
    size_t capacity = upload->capacity ? upload->capacity : FIRST_CAPACITY;
    while (capacity < needed)
        capacity *= 2; /* needed is at most PROTOCOL_MAX_UPLOAD_BYTES */
    if (capacity > upload->begin.size_bytes)
        capacity = upload->begin.size_bytes;
    uint8_t *file = realloc(upload->file, capacity);
    if (!file)
        return false;
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
    struct store *store = upload->store;
    uint8_t *file = upload->file;
    upload->store = NULL;
    upload->file = NULL;
    enum asset_kind kind = begin->kind == sheen_UploadKind_UPLOAD_MODEL ? ASSET_MODEL : ASSET_IMAGE;
    bool ok =
        store_add(store, upload->owner, kind, sha256, begin->name, file, upload->received, error);
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
    if (!grow(upload, upload->received + size) || !EVP_DigestUpdate(upload->hash, bytes, size)) {
        error_set(error, ERROR_SERVER, "%s: no memory for its %llu bytes", upload->begin.name,
                  (unsigned long long)upload->begin.size_bytes);
        return UPLOAD_NO_ROOM;
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
