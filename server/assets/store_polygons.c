/* Polygons of the store's models. */
#include <string.h>

#include "server/assets/store_internal.h"

/* Charges the memory of polygons, on the device or in main memory, to an account of the model's
 * holder. */
static bool reserve_polygons(struct asset *charged, struct asset *model, uint32_t level,
                             struct error *error)
{
    size_t bytes = renderer_polygon_bytes(&model->model->tables, level);
    return store_reserve(model->store, model->share->id, &charged->account, ACCOUNT_ASSETS, bytes,
                         model->name, ERROR_REQUEST, error);
}

static void polygons_finished(void *owner, struct renderer_polygons *polygons,
                              const struct error *failure)
{
    struct asset *asset = owner, *model = asset->of;
    struct error again = {0};
    asset->store->n_polygons_made--;
    asset->polygons = polygons;
    asset->state = polygons ? ASSET_READY : ASSET_STORED;
    if (!polygons)
        account_refund(&asset->account, ACCOUNT_ASSETS, account_used(&asset->account));
    /* The build was given up, but a request has asked for the polygons since. */
    if (!polygons && asset->was_unwanted && !LIST_EMPTY(&asset->waiters)) {
        if (store_start_polygons(asset, &again)) {
            model->users--;
            return;
        }
        failure = &again;
    }
    store_wake_waiters(asset, failure);
    model->users--;
}

/* The model counts as in use while its polygons are made. */
bool store_start_polygons(struct asset *asset, struct error *error)
{
    struct store *store = asset->store;
    const struct polygons_order order = {
        .pool = store->slices.pool,
        .tables = &asset->of->model->tables,
        .level = asset->level,
        .cancelled = &store->cancelled,
        .is_unwanted = &asset->is_unwanted,
        .finished = polygons_finished,
        .owner = asset,
    };
    if (!reserve_polygons(asset, asset->of, asset->level, error))
        return false;
    if (!polygons_build_start(&order, error)) {
        account_refund(&asset->account, ACCOUNT_ASSETS, account_used(&asset->account));
        return false;
    }
    asset->was_unwanted = false;
    asset->state = ASSET_BUILDING;
    asset->of->users++;
    store->n_polygons_made++;
    return true;
}

struct asset *store_find_polygons(struct asset *model, uint32_t level, struct error *error)
{
    struct store *store = model->store;
    struct asset *asset;
    if (!(model->polygon_levels & 1u << level) && !reserve_polygons(model, model, level, error))
        return NULL;
    model->polygon_levels |= 1u << level;
    LIST_FOREACH (asset, store_bucket(store, model->sha256), bucket_link)
        if (asset->of == model && asset->level == level)
            return asset;
    asset = store_add_entry(store, model->share->id);
    if (!asset) {
        error_set(error, ERROR_SERVER, "%s: no room for its polygons: try again later",
                  model->name);
        return NULL;
    }
    store_enter(asset, ASSET_POLYGONS, model->sha256, model->owner);
    memcpy(asset->name, model->name, sizeof asset->name);
    asset->of = model;
    asset->level = level;
    TAILQ_INSERT_AFTER(&store->by_use, model, asset, use_link);
    return asset;
}
