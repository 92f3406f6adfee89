#include "server/assets/memory.h"

#include <inttypes.h>

struct memory_charge {
    struct memory *memory;
    struct peer *peer;
    uint64_t bytes;
    bool is_patient;
};

/* In a private daemon all of the budget is its only client's. */
static bool fits_peer(const struct memory *memory, const struct peer *peer, uint64_t bytes)
{
    uint64_t limit = memory->limits->peer_memory;
    return store_is_private(memory->store) ||
           (peer->memory_bytes <= limit && bytes <= limit - peer->memory_bytes);
}

static bool refuse_peer(const struct memory *memory, const struct peer *peer, const char *what,
                        uint64_t bytes, struct error *error)
{
    return error_set(error, ERROR_SERVER,
                     "%s needs %" PRIu64 " bytes; of the %" PRIu64 " that uploads and frames of %s "
                     "may take (--peer-memory), %" PRIu64 " are in use now: try again later",
                     what, bytes, memory->limits->peer_memory, peer->name, peer->memory_bytes);
}

/* Stills and batches leave room for interactive frames, and those of one peer for others': he may
 * read them as slowly as stall-timeout lets him. */
static bool fits_patient(const struct memory *memory, const struct peer *peer, uint64_t bytes)
{
    uint64_t most = memory->limits->memory_budget / 2;
    return memory->patient_bytes == 0 ||
           (memory->patient_bytes + bytes <= most && peer->patient_bytes <= most / 2);
}

static bool take(struct memory *memory, struct peer *peer, const uint8_t *asker, bool is_patient,
                 uint64_t bytes, struct error *error)
{
    if (is_patient && !fits_patient(memory, peer, bytes))
        return false; /* there are others: later */
    if (!fits_peer(memory, peer, bytes))
        return refuse_peer(memory, peer, "a frame", bytes, error);
    return store_reserve(memory->store, asker, bytes, "a frame", ERROR_REQUEST, error);
}

enum memory_result memory_charge_frame(struct memory *memory, struct peer *peer,
                                       const uint8_t asker[static STORE_OWNER_BYTES],
                                       enum request_class request_class, uint64_t bytes,
                                       struct memory_charge **charge, struct error *error)
{
    bool is_patient = request_class != CLASS_INTERACTIVE;
    struct memory_charge *made = block_cache_take(memory->block_cache, sizeof *made);
    if (!made) {
        error_set(error, ERROR_SERVER, "no memory for a frame: try again later");
        return MEMORY_FAILED;
    }
    if (!take(memory, peer, asker, is_patient, bytes, error)) {
        block_cache_give(memory->block_cache, made);
        return memory->frame_bytes > 0 ? MEMORY_LATER : MEMORY_FAILED;
    }
    *made = (struct memory_charge){memory, peer_reference(peer), bytes, is_patient};
    peer->memory_bytes += bytes;
    memory->frame_bytes += bytes;
    memory->patient_bytes += is_patient ? bytes : 0;
    peer->patient_bytes += is_patient ? bytes : 0;
    *charge = made;
    return MEMORY_CHARGED;
}

void memory_charge_shrink(struct memory_charge *charge, uint64_t bytes)
{
    if (bytes >= charge->bytes)
        return;
    struct memory *memory = charge->memory;
    uint64_t less = charge->bytes - bytes;
    charge->bytes = bytes;
    charge->peer->memory_bytes -= less;
    memory->frame_bytes -= less;
    memory->patient_bytes -= charge->is_patient ? less : 0;
    charge->peer->patient_bytes -= charge->is_patient ? less : 0;
    store_release(memory->store, less);
}

void memory_charge_release(void *owner)
{
    struct memory_charge *charge = owner;
    if (!charge)
        return;
    memory_charge_shrink(charge, 0);
    peer_put(&charge->memory->peers, charge->peer);
    block_cache_give(charge->memory->block_cache, charge);
}

bool memory_charge_input(struct memory *memory, struct peer *peer,
                         const uint8_t asker[static STORE_OWNER_BYTES], uint64_t bytes,
                         const char *name, enum error_kind permanent, struct error *error)
{
    if (!fits_peer(memory, peer, bytes))
        return refuse_peer(memory, peer, name, bytes, error);
    if (!store_reserve(memory->store, asker, bytes, name, permanent, error))
        return false;
    peer->memory_bytes += bytes;
    return true;
}

void memory_release_input(struct memory *memory, struct peer *peer, uint64_t bytes, bool stored)
{
    peer->memory_bytes -= bytes;
    if (!stored)
        store_release(memory->store, bytes);
}
