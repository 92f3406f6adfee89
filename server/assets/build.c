#include "server/assets/build.h"

#include "server/surface/tables.h"

/* Bytes of even the smallest model: its names, buffers and textures. */
#define OVERHEAD_BYTES ((size_t)8192)

size_t build_model_bytes(const struct build_order *order, const struct limit_tables *tables)
{
    return renderer_model_bytes(render_thread_device(order->render_thread), tables) +
           limit_tables_host_bytes(tables) + OVERHEAD_BYTES;
}
