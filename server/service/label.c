#include "server/service/label.h"

#include <stdio.h>
#include <string.h>

enum { VERSION, DEVICE, DRIVER, SOFTWARE, MODEL, CAMERA, LIGHT, PATTERN };

static const char *const NAMES[LABEL_ATTRIBUTES] = {
    [VERSION] = "sheen:version",   [DEVICE] = "sheen:device",   [DRIVER] = "sheen:driver",
    [SOFTWARE] = "sheen:software", [MODEL] = "sheen:model",     [CAMERA] = "sheen:camera",
    [LIGHT] = "sheen:light",       [PATTERN] = "sheen:pattern",
};

#define VEC3 "%.17g,%.17g,%.17g"
#define VEC3_OF(v) (v)[0], (v)[1], (v)[2]
#define COLOUR "%.9g,%.9g,%.9g,%.9g"
#define COLOUR_OF(c) (double)(c)[0], (double)(c)[1], (double)(c)[2], (double)(c)[3]

static void describe_camera(char *value, const struct camera *camera)
{
    bool ortho = camera->kind == CAMERA_ORTHOGRAPHIC;
    snprintf(value, LABEL_VALUE_BYTES, "eye=" VEC3 " target=" VEC3 " up=" VEC3 " %s=%.17g",
             VEC3_OF(camera->eye), VEC3_OF(camera->target), VEC3_OF(camera->up),
             ortho ? "ortho_height" : "fov_deg", ortho ? camera->ortho_height : camera->fov_deg);
}

static void describe_pattern(char *value, const struct frame_request *request,
                             const char *image_hex)
{
    static const char *const kinds[] = {"stripes", "lattice", "circles", "image"};
    const struct pattern *pattern = &request->pattern;
    int n = snprintf(value, LABEL_VALUE_BYTES,
                     "%s count=%.17g duty=%.17g foreground=" COLOUR " background=" COLOUR
                     " miss=" COLOUR " empty=" COLOUR,
                     kinds[pattern->kind], pattern->count, pattern->duty,
                     COLOUR_OF(pattern->foreground), COLOUR_OF(pattern->background),
                     COLOUR_OF(request->miss), COLOUR_OF(request->empty));
    if (image_hex && n > 0 && n < LABEL_VALUE_BYTES)
        snprintf(value + n, (size_t)(LABEL_VALUE_BYTES - n), " image=%s", image_hex);
}

void label_init(struct label *label, const struct frame_request *request,
                const struct renderer_info *info, const char *model_hex, const char *image_hex)
{
    for (int i = 0; i < LABEL_ATTRIBUTES; i++)
        label->attributes[i] = (struct image_attribute){NAMES[i], label->values[i]};
    snprintf(label->values[VERSION], LABEL_VALUE_BYTES, "%s", SHEEN_VERSION);
    snprintf(label->values[DEVICE], LABEL_VALUE_BYTES, "%s", info->device);
    snprintf(label->values[DRIVER], LABEL_VALUE_BYTES, "%s", info->driver);
    snprintf(label->values[SOFTWARE], LABEL_VALUE_BYTES, "%s", info->software ? "yes" : "no");
    snprintf(label->values[MODEL], LABEL_VALUE_BYTES, "%s", model_hex);
    describe_camera(label->values[CAMERA], &request->camera);
    snprintf(label->values[LIGHT], LABEL_VALUE_BYTES, "centre=" VEC3 " u=" VEC3 " v=" VEC3,
             VEC3_OF(request->light.centre), VEC3_OF(request->light.u), VEC3_OF(request->light.v));
    describe_pattern(label->values[PATTERN], request, image_hex);
}
