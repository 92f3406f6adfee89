/* The metadata of a picture file: everything that determines the picture (model, camera, lights,
 * device, version), and no time, so that equal frames give equal files. Pure, any thread. */
#ifndef SHEEN_OUTPUT_METADATA_H
#define SHEEN_OUTPUT_METADATA_H

#include "protocol/messages/message.h"
#include "server/render/renderer.h"
#include "server/image/image.h"

#define METADATA_ATTRIBUTES 11 /* at most PICTURE_MAX_ATTRIBUTES */
#define METADATA_VALUE_BYTES 8192

/* `attributes` points into `values`: do not copy or move the struct once it is filled in. */
struct metadata {
    struct image_attribute attributes[METADATA_ATTRIBUTES];
    char values[METADATA_ATTRIBUTES][METADATA_VALUE_BYTES];
};

/* `request` is the frame as drawn, with all defaults filled in. `asked` is the message that it was
 * made from; asked->show.range must already hold the range that was used. A value that is too long
 * is cut off. */
void metadata_init(struct metadata *metadata, const struct frame_request *request,
                   const sheen_Render *asked, const struct renderer_info *info);

#endif
