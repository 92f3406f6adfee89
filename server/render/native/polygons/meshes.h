/* The meshes of polygons that the native device keeps: those of the last frames of polygons. A frame holds its own as long
 * as it takes, whatever is dropped here. The thread that has the device. */
#ifndef SHEEN_RENDER_NATIVE_POLYGONS_MESHES_H
#define SHEEN_RENDER_NATIVE_POLYGONS_MESHES_H

#include "server/render/mesh.h"

enum { MAX_NATIVE_MESHES = 32 };

/* All zero: none. */
struct native_meshes {
    struct native_kept_mesh {
        struct renderer_polygons *polygons; /* NULL: a free place */
        uint64_t serial;                    /* of the model */
        uint32_t level;
        uint64_t used; /* by the clock */
    } mesh[MAX_NATIVE_MESHES];
    uint64_t clock;
};

/* A model's mesh of a level, which the caller holds from here on; NULL where there is none. */
struct renderer_polygons *native_meshes_find(struct native_meshes *meshes, uint64_t serial,
                                             uint32_t level);
/* Keeps a mesh; the meshes not used for longest make room. */
void native_meshes_keep(struct native_meshes *meshes, uint64_t serial, uint32_t level,
                        struct renderer_polygons *polygons);
/* Drops those of a model that goes. */
void native_meshes_forget(struct native_meshes *meshes, uint64_t serial);
void native_meshes_finish(struct native_meshes *meshes);

#endif
