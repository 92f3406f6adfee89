/* What a picture file says about itself: everything that made it, and no time, so that equal frames
 * are equal files. Pure, any thread. */
#ifndef SHEEN_OUTPUT_METADATA_H
#define SHEEN_OUTPUT_METADATA_H

#include "protocol/message.h"
#include "server/render/renderer.h"
#include "server/image/image.h"

#define METADATA_ATTRIBUTES 11 /* at most PICTURE_MAX_ATTRIBUTES */
#define METADATA_VALUE_BYTES 8192

/* Attributes point into the struct itself: it must not be moved once filled in. */
struct metadata {
    struct image_attribute attributes[METADATA_ATTRIBUTES];
    char values[METADATA_ATTRIBUTES][METADATA_VALUE_BYTES];
};

/* `asked` is the message that the request was made from; its show.range is as used. */
void metadata_init(struct metadata *metadata, const struct frame_request *request,
                   const sheen_Render *asked, const struct renderer_info *info);

#endif
