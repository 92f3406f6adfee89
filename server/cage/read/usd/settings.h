/* The settings of USD's meshes, and those of them that all meshes of a cage must share. Internal to
 * the USD reader. Any thread. */
#ifndef SHEEN_CAGE_READ_USD_SETTINGS_H
#define SHEEN_CAGE_READ_USD_SETTINGS_H

#include "server/cage/read/usd/prim.h"

/* The settings of one mesh. */
struct usd_settings {
    enum cage_scheme scheme;
    enum cage_boundary boundary;
    bool smooth_triangles;
    bool left_handed; /* faces are clockwise seen from outside */
};

/* Reads the settings, with USD's own values for those that the mesh does not have. False with
 * ERROR_MODEL, also for the scheme "none". */
bool usd_read_settings(struct usd_settings *settings, const struct usd_values *values,
                       const struct usd_file *file);

/* A setting that was given, and the line of the mesh that gave it. */
struct usd_given {
    bool is;
    uint32_t line;
};

/* What the meshes before have given. The caller sets `cage`, which takes the settings, and `file`,
 * and zeroes the rest. */
struct usd_shared {
    struct cage *cage;
    const struct usd_file *file;
    struct usd_given scheme, boundary, catmull_clark_triangles, smooth_triangles;
    bool mixed_boundaries; /* meshes differ in edgeOnly and edgeAndCorner */
};

/* Gives the scheme and the boundary of a mesh to the cage. Meshes of edgeOnly and of edgeAndCorner
 * may be in one cage: it has edgeOnly, and the corners of the latter need tags. False with
 * ERROR_MODEL if the mesh differs otherwise from one before. */
bool usd_share_settings(struct usd_shared *shared, const struct usd_prim *prim,
                        const struct usd_settings *settings);

/* Gives the rule of triangles to the cage. It matters only to meshes that have triangles: false
 * with ERROR_MODEL if two of these differ. */
bool usd_share_triangle_rule(struct usd_shared *shared, const struct usd_prim *prim, bool smooth,
                             bool has_triangle);

#endif
