#include "server/assets/build.h"

#include "server/surface/tables.h"

/* Bytes of even the smallest model: its names, buffers and textures. */
#define OVERHEAD_BYTES ((size_t)8192)

size_t build_model_bytes(const struct build_order *order, const struct limit_tables *tables)
{
    return renderer_model_bytes(render_thread_device(order->render_thread), tables) +
           limit_tables_host_bytes(tables) + OVERHEAD_BYTES;
}

/* Returns false. */
static bool name_other_device(const struct build_order *order, struct error *error)
{
    const struct error found = *error;
    if (found.kind != ERROR_MODEL ||
        renderer_takes_tables_on_demand(render_thread_device(order->render_thread)))
        return false;
    return error_set(error, found.kind, "%s; with --device native, triangles need a twentieth",
                     found.text);
}

bool build_may_need_model(const struct build_order *order, const struct limit_tables *tables,
                          size_t plan_bytes, struct error *error)
{
    return order->may_need(order->owner, build_model_bytes(order, tables) + plan_bytes, error) ||
           name_other_device(order, error);
}

bool build_reserve_model(const struct build_order *order, const struct limit_tables *tables,
                         struct error *error)
{
    return order->reserve(order->owner, build_model_bytes(order, tables), error) ||
           name_other_device(order, error);
}
