#include "server/render/native/polygons/meshes.h"

#include <stddef.h>

/* Upper limit on the memory of all meshes together. */
static const size_t MAX_KEPT_BYTES = (size_t)512 << 20;

static void drop(struct native_kept_mesh *kept)
{
    polygons_release(kept->polygons);
    *kept = (struct native_kept_mesh){0};
}

static size_t bytes_of(const struct renderer_polygons *polygons)
{
    const struct mesh *mesh = &polygons->mesh;
    return mesh->n_vertices * sizeof *mesh->vertex + mesh->n_indices * sizeof *mesh->index;
}

struct renderer_polygons *native_meshes_find(struct native_meshes *meshes, uint64_t serial,
                                             uint32_t level)
{
    for (int i = 0; i < MAX_NATIVE_MESHES; i++) {
        struct native_kept_mesh *kept = &meshes->mesh[i];
        if (!kept->polygons || kept->serial != serial || kept->level != level)
            continue;
        kept->used = ++meshes->clock;
        polygons_hold(kept->polygons);
        return kept->polygons;
    }
    return NULL;
}

void native_meshes_keep(struct native_meshes *meshes, uint64_t serial, uint32_t level,
                        struct renderer_polygons *polygons)
{
    for (;;) {
        struct native_kept_mesh *free_one = NULL, *oldest = NULL;
        size_t bytes = bytes_of(polygons);
        for (int i = 0; i < MAX_NATIVE_MESHES; i++) {
            struct native_kept_mesh *kept = &meshes->mesh[i];
            if (!kept->polygons) {
                free_one = kept;
                continue;
            }
            bytes += bytes_of(kept->polygons);
            oldest = oldest && oldest->used < kept->used ? oldest : kept;
        }
        if (free_one && (!oldest || bytes <= MAX_KEPT_BYTES)) {
            polygons_hold(polygons);
            *free_one = (struct native_kept_mesh){polygons, serial, level, ++meshes->clock};
            return;
        }
        drop(oldest);
    }
}

void native_meshes_forget(struct native_meshes *meshes, uint64_t serial)
{
    for (int i = 0; i < MAX_NATIVE_MESHES; i++)
        if (meshes->mesh[i].serial == serial)
            drop(&meshes->mesh[i]);
}

void native_meshes_finish(struct native_meshes *meshes)
{
    for (int i = 0; i < MAX_NATIVE_MESHES; i++)
        drop(&meshes->mesh[i]);
}
