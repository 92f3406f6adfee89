/* The meshes of polygons that the native device keeps: those of the latest frames. A frame holds its mesh as long as
 * needed, whatever is dropped here. The thread that has the device. */
#ifndef SHEEN_RENDER_NATIVE_POLYGONS_MESHES_H
#define SHEEN_RENDER_NATIVE_POLYGONS_MESHES_H

#include "server/render/mesh.h"

enum { MAX_NATIVE_MESHES = 32 };

/* All zero: no meshes. */
struct native_meshes {
    struct native_kept_mesh {
        struct renderer_polygons *polygons; /* NULL: unused */
        uint64_t serial;                    /* the model's serial */
        uint32_t level;
        uint64_t used; /* time of the last use, by `clock` */
    } mesh[MAX_NATIVE_MESHES];
    uint64_t clock;
};

/* Finds a model's mesh of a level, which the caller then holds; NULL if there is none. */
struct renderer_polygons *native_meshes_find(struct native_meshes *meshes, uint64_t serial,
                                             uint32_t level);
/* Keeps a mesh; the least recently used ones make room. */
void native_meshes_keep(struct native_meshes *meshes, uint64_t serial, uint32_t level,
                        struct renderer_polygons *polygons);
/* Drops the meshes of a model that is destroyed. */
void native_meshes_forget(struct native_meshes *meshes, uint64_t serial);
void native_meshes_finish(struct native_meshes *meshes);

#endif
