/* Walks through the prims of a layer and makes a cage of its meshes. Internal to the USD reader.
 * Any thread. */
#ifndef SHEEN_CAGE_READ_USD_STAGE_H
#define SHEEN_CAGE_READ_USD_STAGE_H

#include "server/cage/build/builder.h"
#include "server/cage/read/usd/layer.h"

/* Adds the meshes that are visible and neither of purpose guide nor proxy to an empty builder, with
 * their transforms, and warns of what is passed over. False with ERROR_MODEL, also if no mesh
 * remains, or with ERROR_SERVER when memory is short. */
bool usd_stage_build(struct cage_builder *builder, const struct usd_layer *layer);

#endif
