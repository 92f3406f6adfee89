/* The camera and light of a request that leaves them out, and the zoom of a given camera. They
 * depend only on the model and the request. Pure, any thread. */
#ifndef SHEEN_SCENE_DEFAULTS_H
#define SHEEN_SCENE_DEFAULTS_H

#include "server/scene/scene.h"

struct limit_tables;

/* Guesses the up direction of a model whose file has none: y if the box is thinner in y than in z
 * by more than 1 %, else z. */
void scene_guess_up(const double box_min[3], const double box_max[3], double up[3]);

/* A camera that frames the model: 35 degrees, with a margin of 4 % at the two opposite edges of the
 * picture to which the model comes nearest. `up` is the up direction, of any length; NULL:
 * guessed. */
void scene_default_camera(const struct limit_tables *tables, const double up[3],
                          enum default_view view, uint32_t width_px, uint32_t height_px,
                          struct camera *camera);

/* Sets camera->up for a model with the up direction `up`, of any length but 0; eye and target must
 * be set. It is `up` itself, unless the camera looks along it (within 1e-6 rad): then it is the
 * horizontal direction in which the front view looks if the camera looks down, and the opposite one
 * if it looks up. */
void scene_default_roll(const double up[3], struct camera *camera);

/* Zooms: magnifies the picture by `factor` (RANGE_ZOOM) around its place (x, y), which moves to the
 * middle; (0, 0) is the top left and (1, 1) the bottom right (RANGE_ZOOM_AT). The eye of a
 * perspective camera stays and its target moves, so that no line moves on the surface; eye and
 * target of an orthographic camera both move sideways. fov_deg and ortho_height are reduced, and
 * may leave their ranges: the caller checks that. */
void scene_zoom(struct camera *camera, uint32_t width_px, uint32_t height_px, double factor,
                double x, double y);

/* Sets centre, u and v of a light by its kind, the box and `up` (NULL: guessed). The camera has no
 * influence, so that lines do not move with the view. Lines run along the longer of the model's
 * horizontal sides. A tunnel has its axis in that direction and is three times as wide as the box:
 * every ray from the model meets it, except along the axis. A sphere is such a tunnel with infinite
 * radius. A rectangle or plane is above the model, and visible from below if one-sided. */
void scene_default_light(const double box_min[3], const double box_max[3], const double up[3],
                         struct light *light);

#endif
