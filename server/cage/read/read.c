#include "server/cage/read/read.h"

#include <string.h>

#include "protocol/model_format.h"
#include "server/cage/build/builder.h"
#include "server/cage/build/inspect.h"
#include "server/cage/read/bpt.h"
#include "server/cage/read/gltf/gltf.h"
#include "server/cage/build/repair.h"
#include "server/cage/read/obj.h"
#include "server/cage/read/patches.h"
#include "server/cage/read/usd/usd.h"
#include "server/cage/build/weld.h"

/* The largest length of a name in a message, so that room is left for the reason. */
#define SHOWN_NAME_BYTES 160

/* The name for messages; of a long name its end, which has the file's own name. */
static const char *shown_name(const char *name)
{
    if (!name || !*name)
        return "cage";
    size_t length = strlen(name);
    return length > SHOWN_NAME_BYTES ? name + length - SHOWN_NAME_BYTES : name;
}

typedef bool reader(struct cage_builder *, const void *, size_t, const char *, struct error *);
static reader *const READERS[] = {[MODEL_OBJ] = obj_read,
                                  [MODEL_GLTF] = gltf_read,
                                  [MODEL_USD] = usd_read,
                                  [MODEL_BPT] = bpt_read,
                                  [MODEL_PATCHES] = patches_read};

/* Repair follows welding, because it also removes corners that welding has made equal. */
static bool weld_and_repair(struct cage_builder *builder, const char *name, struct error *error)
{
    const struct weld_start start = {0};
    return (!builder->weld || cage_weld(builder, &start, name, error)) &&
           cage_repair(builder, name, error);
}

bool cage_read(struct cage *cage, const void *bytes, size_t size, const char *name,
               struct error *error)
{
    *cage = (struct cage){0};
    name = shown_name(name);
    if (size == 0)
        return error_set(error, ERROR_MODEL, "%s: the file is empty", name);
    struct cage_builder builder = {.name = name};
    bool ok = READERS[model_format(name, bytes, size)](&builder, bytes, size, name, error) &&
              weld_and_repair(&builder, name, error) && cage_check(&builder.cage, name, error);
    if (ok) {
        cage_inspect(&builder, name);
        *cage = builder.cage;
        builder.cage = (struct cage){0};
    }
    cage_builder_finish(&builder);
    return ok;
}
