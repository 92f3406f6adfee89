/* Adds USD's meshes to a cage. Internal to the USD reader. Any thread. */
#ifndef SHEEN_CAGE_READ_USD_MESH_H
#define SHEEN_CAGE_READ_USD_MESH_H

#include "server/cage/build/builder.h"
#include "server/cage/read/usd/xform.h"

/* One mesh that has points and faces. */
struct usd_mesh {
    const struct usd_values *values;
    const struct usd_file *file;
    struct cage_builder *builder;
    const struct transform *world;
    bool is_placed;     /* apply `world`; else it is the identity */
    bool turn_faces;    /* reverse them, but keep their first corners */
    bool sharp_corners; /* tag vertices of one face as infinitely sharp */
    /* Where the mesh begins in the builder. */
    size_t first_vertex, first_face;
    bool has_triangle;  /* set by usd_add_mesh() */
    bool *has_negative; /* set if a sharpness is below 0; never NULL, never cleared */
};

/* Adds points, faces and tags. A tag of a vertex or face that the mesh does not have gets the index
 * UINT32_MAX, and cage_repair() leaves it out. False with ERROR_MODEL, which names the line, or
 * with the builder's errors. */
bool usd_add_mesh(struct usd_mesh *mesh);

/* Adds the creases, corners and holes of a mesh whose points and faces were added. Part of
 * usd_add_mesh(). */
bool usd_add_tags(struct usd_mesh *mesh);

#endif
