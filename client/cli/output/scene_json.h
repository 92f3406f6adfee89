/* Writes what a frame shows as JSON: every option of drawing, as used.
 *
 * Thread: one. */
#ifndef SHEEN_CLIENT_SCENE_JSON_H
#define SHEEN_CLIENT_SCENE_JSON_H

#include "client/cli/output/json.h"
#include "client/lib/sheen.h"

/* Writes these keys into the open object: camera, lines, line_eye, light (the first), lights,
 * colours, filter, surface, show, planes. Values that the daemon chose come from the frame, all
 * others from the request. */
void scene_json(struct json *json, const struct sheen_request *request,
                const struct sheen_frame *frame);

/* Writes the keys camera, lines, line_eye, light (the first) and lights: what numbers about lines were computed for.
 * n is at least 1. */
void scene_json_lines(struct json *json, const struct sheen_camera *camera,
                      const struct sheen_lines *lines, const struct sheen_light *lights,
                      uint32_t n);

#endif
