#include "server/assets/memory.h"

#include <inttypes.h>

struct memory_charge {
    struct block_cache *block_cache;
    struct client_quota *quota;
    enum account_class class;
    uint64_t bytes;
    uint64_t device_bytes; /* charged to the daemon's account */
    struct account *daemon;
};

/* --- what nobody in particular uses */

/* Makes the charge of a class of the daemon's own account what is used now. */
static void set_used(struct account *daemon, enum account_class class, uint64_t *charged,
                     uint64_t bytes)
{
    account_refund(daemon, class, *charged);
    account_charge(daemon, class, bytes);
    *charged = bytes;
}

static void count_spares(struct memory *memory)
{
    set_used(store_account(memory->store), ACCOUNT_SPARES, &memory->spare_bytes,
             block_cache_bytes(memory->block_cache));
}

static void drop_run(struct task *task, void *context)
{
    struct memory *memory = task->owner;
    renderer_drop_held(context);
    memory->left = renderer_held(context);
}

static void drop_done(struct task *task)
{
    struct memory *memory = task->owner;
    memory->is_dropping = false;
    memory_set_held(memory, &memory->left);
}

/* The render thread frees what the device holds before it draws what is submitted after this. */
static void drop_held(struct memory *memory)
{
    if (memory->held_bytes + memory->programs_bytes == 0 || memory->is_dropping)
        return;
    memory_set_held(memory, &(struct renderer_held){0, 0});
    memory->is_dropping = true;
    memory->drop = (struct task){drop_run, drop_done, memory, {NULL}};
    render_thread_submit(memory->render_thread, &memory->drop);
}

static void relieve(void *owner, uint64_t bytes, bool is_last_resort)
{
    struct memory *memory = owner;
    const struct account *daemon = store_account(memory->store);
    count_spares(memory);
    if (bytes <= account_room(daemon))
        return;
    block_cache_drop(memory->block_cache);
    count_spares(memory);
    if (is_last_resort && bytes > account_room(daemon))
        drop_held(memory);
}

void memory_set_held(struct memory *memory, const struct renderer_held *held)
{
    struct account *daemon = store_account(memory->store);
    if (memory->is_dropping)
        return;
    set_used(daemon, ACCOUNT_DEVICE, &memory->held_bytes, held->frames);
    set_used(daemon, ACCOUNT_DEVICE, &memory->programs_bytes, held->programs);
}

void memory_count(struct memory *memory)
{
    count_spares(memory);
}

/* --- clients */

void memory_init(struct memory *memory, struct store *store, const struct asset_limits *limits,
                 bool is_private, struct render_thread *render_thread,
                 struct block_cache *block_cache)
{
    *memory =
        (struct memory){.store = store, .render_thread = render_thread, .block_cache = block_cache};
    store_set_relief(store, &(struct store_relief){relieve, memory});
    client_quotas_init(&memory->quotas, store_account(store),
                       is_private ? ACCOUNT_NO_LIMIT : limits->peer_memory);
}

static bool refuse_peer(const struct client_quota *quota, const char *what, uint64_t bytes,
                        struct error *error)
{
    return error_set(error, ERROR_SERVER,
                     "%s needs %" PRIu64 " bytes; of the %" PRIu64 " that uploads and frames of %s "
                     "may take (--peer-memory), %" PRIu64 " are in use now: try again later",
                     what, bytes, quota->account.limit, quota->name, account_used(&quota->account));
}

/* Stills and batches must leave room for interactive frames, and those of one identity must leave
 * room for others: a client may read its frames as slowly as stall-timeout allows. */
static bool fits_patient(const struct memory *memory, const struct client_quota *quota,
                         uint64_t bytes)
{
    const struct account *daemon = store_account(memory->store);
    uint64_t most = daemon->limit / 2, used = daemon->used[ACCOUNT_PATIENT];
    return used == 0 || (used + bytes <= most && quota->account.used[ACCOUNT_PATIENT] <= most / 2);
}

static bool take(struct memory *memory, struct client_quota *quota, const uint8_t *asker,
                 enum account_class class, const struct memory_frame *frame, struct error *error)
{
    struct account *daemon = store_account(memory->store);
    if (class == ACCOUNT_PATIENT && !fits_patient(memory, quota, frame->bytes))
        return false; /* other patient frames use the memory: try later */
    if (frame->bytes > account_room(&quota->account))
        return refuse_peer(quota, frame->what, frame->bytes, error);
    if (!store_reserve(memory->store, asker, daemon, ACCOUNT_DEVICE,
                       frame->bytes + frame->device_bytes, frame->what, ERROR_REQUEST, error))
        return false;
    account_refund(daemon, ACCOUNT_DEVICE, frame->bytes);
    account_charge(&quota->account, class, frame->bytes);
    return true;
}

enum memory_result memory_charge_frame(struct memory *memory, struct client_quota *quota,
                                       const uint8_t asker[static OWNER_BYTES],
                                       enum account_class class, const struct memory_frame *frame,
                                       struct memory_charge **charge, struct error *error)
{
    struct account *daemon = store_account(memory->store);
    struct memory_charge *made = block_cache_take(memory->block_cache, sizeof *made);
    if (!made) {
        error_set(error, ERROR_SERVER, "no memory for %s: try again later", frame->what);
        return MEMORY_FAILED;
    }
    if (!take(memory, quota, asker, class, frame, error)) {
        const uint64_t *used = daemon->used;
        block_cache_give(memory->block_cache, made);
        return used[ACCOUNT_INTERACTIVE] + used[ACCOUNT_PATIENT] > 0 ? MEMORY_LATER : MEMORY_FAILED;
    }
    *made = (struct memory_charge){.block_cache = memory->block_cache,
                                   .quota = client_quota_reference(quota),
                                   .class = class,
                                   .bytes = frame->bytes,
                                   .device_bytes = frame->device_bytes,
                                   .daemon = daemon};
    *charge = made;
    return MEMORY_CHARGED;
}

void memory_charge_drawn(struct memory_charge *charge)
{
    account_refund(charge->daemon, ACCOUNT_DEVICE, charge->device_bytes);
    charge->device_bytes = 0;
}

void memory_charge_shrink(struct memory_charge *charge, uint64_t bytes)
{
    if (bytes >= charge->bytes)
        return;
    account_refund(&charge->quota->account, charge->class, charge->bytes - bytes);
    charge->bytes = bytes;
}

void memory_charge_release(void *owner)
{
    struct memory_charge *charge = owner;
    if (!charge)
        return;
    memory_charge_drawn(charge);
    memory_charge_shrink(charge, 0);
    client_quota_put(charge->quota);
    block_cache_give(charge->block_cache, charge);
}

bool memory_charge_input(struct memory *memory, struct client_quota *quota,
                         const uint8_t asker[static OWNER_BYTES], uint64_t bytes, const char *name,
                         enum error_kind permanent, struct error *error)
{
    if (bytes > account_room(&quota->account))
        return refuse_peer(quota, name, bytes, error);
    return store_reserve(memory->store, asker, &quota->account, ACCOUNT_INPUT, bytes, name,
                         permanent, error);
}

void memory_refund_input(struct client_quota *quota, uint64_t bytes)
{
    account_refund(&quota->account, ACCOUNT_INPUT, bytes);
}
