/* The view and the light of a request that names none, and a closer look at a given view. They
 * depend on the model and on what is asked alone. Pure, any thread. */
#ifndef SHEEN_SCENE_DEFAULTS_H
#define SHEEN_SCENE_DEFAULTS_H

#include "server/scene/scene.h"

struct limit_tables;

/* Which way is up where no file says it: y when the box is thinner in y than in z by more than 1 %,
 * else z. */
void scene_guess_up(const double box_min[3], const double box_max[3], double up[3]);

/* A camera that frames the model: 35 degrees, 4 % of the picture free at the two opposite edges
 * that it comes nearest to. `up` says where above is, of any length; NULL: guessed. */
void scene_default_camera(const struct limit_tables *tables, const double up[3],
                          enum default_view view, uint32_t width_px, uint32_t height_px,
                          struct camera *camera);

/* Sets camera->up for a model whose up is `up`, of any length but 0; eye and target must be set.
 * Where the camera does not look along it (within 1e-6 rad): to `up` itself. Where it does: to the
 * horizontal direction that the front view looks along when the camera looks down, to the opposite
 * one when it looks up. */
void scene_default_roll(const double up[3], struct camera *camera);

/* Looks closer at a place of the picture: (x, y) is (0, 0) at its top left and (1, 1) at its bottom
 * right (RANGE_ZOOM_AT) and comes to lie in its middle; `factor` is RANGE_ZOOM. A perspective
 * camera's eye stays and its target moves, so that lines stay where they are on the surface; an
 * orthographic camera's eye and target both move across. fov_deg and ortho_height both become
 * smaller, whichever the camera uses. They may leave their ranges: the caller checks that. */
void scene_zoom(struct camera *camera, uint32_t width_px, uint32_t height_px, double factor,
                double x, double y);

/* Sets centre, u and v for the light's kind, by the box and `up` (NULL: guessed) alone, so that
 * lines stay where they are whoever looks. Lines run along the longer of the model's horizontal
 * sides. A tunnel is about that direction, three times as wide as the box: every ray from the model
 * meets it but one that runs along its axis. A sphere is that tunnel, infinitely wide; rectangle
 * and plane hang over the model, seen from below where one-sided. */
void scene_default_light(const double box_min[3], const double box_max[3], const double up[3],
                         struct light *light);

#endif
