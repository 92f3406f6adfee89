/* What a picture file says about itself: everything that made it, and no time, so that equal frames
 * are equal files. Pure, any thread. */
#ifndef SHEEN_SERVICE_LABEL_H
#define SHEEN_SERVICE_LABEL_H

#include "server/gpu/renderer.h"
#include "server/image/image.h"

#define LABEL_ATTRIBUTES 8
#define LABEL_VALUE_BYTES 640

/* Attributes point into the struct itself: it must not be moved once filled in. */
struct label {
    struct image_attribute attributes[LABEL_ATTRIBUTES];
    char values[LABEL_ATTRIBUTES][LABEL_VALUE_BYTES];
};

/* model_hex and image_hex (NULL without an image pattern) are SHA-256 in hexadecimal. */
void label_init(struct label *label, const struct frame_request *request,
                const struct renderer_info *info, const char *model_hex, const char *image_hex);

#endif
