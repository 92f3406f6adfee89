/* Prepares a light, its pattern and the line family for the shaders' formulas: computed in double
 * precision relative to the camera's eye, then rounded to single precision. Pure, any thread. */
#ifndef SHEEN_RENDER_LIGHT_BLOCK_H
#define SHEEN_RENDER_LIGHT_BLOCK_H

#include "server/scene/frame_request.h"

/* The std140 block `Light` of shaders/lines.glsl. */
struct light_block {
    float line_eye[4], origin[4];
    float axis_n[4], axis_u[4], axis_v[4];
    float size[4];
    float foreground[4], background[4], miss[4], empty[4], base[4];
    float turn[4], wave[4];
    float single[MAX_LINES];
    float opacity, half_width;
    int32_t n_single, is_hindmost, is_foremost, is_one_sided, has_direction;
    _Alignas(16) int32_t want[4];
};

/* Fills in the block for light i of a checked request. */
void light_block_fill(struct light_block *block, const struct frame_request *request, uint32_t i);

/* True if the image of the light's pattern repeats beyond its sides along s, or along t; else it
 * ends at the light's border. */
bool light_image_repeats_s(const struct frame_request *request, const struct light *light);
bool light_image_repeats_t(const struct frame_request *request, const struct light *light);

#endif
