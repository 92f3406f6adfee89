/* Pictures of a new surface that `sheen compare --align` has moved. The daemon draws the surface
 * where its file has it; so camera, lights and lines are moved back instead, and what the planes
 * hold is moved forwards. The picture is the same. Pure, any thread. */
#ifndef SHEEN_CLIENT_ALIGNED_H
#define SHEEN_CLIENT_ALIGNED_H

#include "client/lib/sheen.h"

/* Moves the request's scene by the inverse of the comparison's motion. Its camera is no automatic
 * one. */
void aligned_request(const struct sheen_comparison *comparison, struct sheen_request *request);
/* Moves the positions and normals of a frame of n pixels, whose planes are those of enum
 * sheen_plane. */
void aligned_frame(const struct sheen_comparison *comparison, struct sheen_frame *frame, size_t n);

#endif
