/* What a frame shows, as JSON: every option that draws, as used.
 *
 * Thread: one. */
#ifndef SHEEN_CLIENT_SCENE_JSON_H
#define SHEEN_CLIENT_SCENE_JSON_H

#include "client/cli/output/json.h"
#include "client/lib/sheen.h"

/* Keys into the object that is open: camera, lines, line_eye, light (the first), lights, colours,
 * antialias, filter, surface, show, planes. What the daemon chose is the frame's, the rest the
 * request's. */
void scene_json(struct json *json, const struct sheen_request *request,
                const struct sheen_frame *frame);

#endif
