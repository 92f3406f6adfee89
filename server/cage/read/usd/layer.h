/* A USD text file as a list of prims, with those of their properties that make a cage. Internal to
 * the USD reader. Any thread. */
#ifndef SHEEN_CAGE_READ_USD_LAYER_H
#define SHEEN_CAGE_READ_USD_LAYER_H

#include "server/cage/cage.h"
#include "server/cage/read/usd/value.h"

/* The largest counts that are read, which bound the memory that a small file can take. */
#define USD_MAX_PRIMS 1000000
#define USD_MAX_PROPERTIES 4000000

/* Properties that make a cage. The names are in layer_properties.c. */
enum usd_property_kind {
    USD_POINTS,
    USD_FACE_VERTEX_COUNTS,
    USD_FACE_VERTEX_INDICES,
    USD_SUBDIVISION_SCHEME,
    USD_INTERPOLATE_BOUNDARY,
    USD_TRIANGLE_RULE,
    USD_ORIENTATION,
    USD_CREASE_INDICES,
    USD_CREASE_LENGTHS,
    USD_CREASE_SHARPNESSES,
    USD_CORNER_INDICES,
    USD_CORNER_SHARPNESSES,
    USD_HOLE_INDICES,
    USD_VISIBILITY,
    USD_PURPOSE,
    USD_XFORM_OP_ORDER,
    N_USD_PROPERTIES,
    USD_XFORM_OP = N_USD_PROPERTIES, /* any property whose name begins with "xformOp:" */
};

/* How a property gives its value. */
enum usd_source {
    USD_DEFAULT, /* by "name = value" */
    USD_SAMPLE,  /* by name.timeSamples: the value is that of the earliest time */
    USD_SPLINE,  /* by name.spline, which is not read */
};

struct usd_property {
    enum usd_property_kind kind;
    enum usd_source source;
    struct usd_token name; /* without ".timeSamples"; its line is that of the property */
    /* Where the value begins; a property whose value is None or [] is not stored. */
    struct usd_text value;
    uint32_t next; /* the prim's next property; USD_NONE: there is none */
};

#define USD_NONE UINT32_MAX

/* A composition arc of a prim (such as a reference), which takes content from elsewhere and is
 * refused: words for the message. */
struct usd_arc {
    const char *what; /* NULL: nothing */
    uint32_t line;
    bool is_instance; /* the prim says `instanceable = true`, which usdcat --flatten keeps */
};

struct usd_prim {
    struct usd_token name; /* its line is that of the prim */
    struct usd_token type; /* of length 0 if it has none */
    uint32_t depth;        /* 0 for a prim that is in no other */
    uint32_t first_property, last_property;
    struct usd_arc arc; /* the prim's first arc */
};

struct usd_layer {
    const struct usd_file *file;
    enum cage_up up;
    /* Prims in the file's order, so that a prim precedes those in it. Prims that are inactive,
     * `over` or `class`, materials, and all in such prims, are left out. */
    struct usd_prim *prim;
    size_t n_prims, prim_capacity;
    struct usd_property *property;
    size_t n_properties, property_capacity;
    uint32_t n_left_out; /* meshes that were left out */
};

/* Reads the whole file into a zeroed layer. False with ERROR_MODEL, which names the line, or with
 * ERROR_SERVER when memory is short. Call usd_layer_finish() in both cases. */
bool usd_layer_read(struct usd_layer *layer, struct usd_text *text);

void usd_layer_finish(struct usd_layer *layer);

/* Adds the property whose name was read from the text, and reads its value, if it is one that makes
 * a cage; else skips the value. `prim` NULL: skips the value in any case. False with ERROR_MODEL,
 * or with ERROR_SERVER when memory is short. Part of usd_layer_read(). */
bool usd_layer_property(struct usd_layer *layer, struct usd_prim *prim, struct usd_text *text,
                        const struct usd_token *name);

/* Reads "( ... )" after a prim, if it follows. *is_active changes if it has `active`. False with
 * ERROR_MODEL. Part of usd_layer_read(). */
bool usd_prim_metadata(struct usd_text *text, struct usd_arc *arc, bool *is_active);

/* Reads "( ... )" after the header of the file, if it follows. Refuses sublayers. False with
 * ERROR_MODEL. Part of usd_layer_read(). */
bool usd_layer_metadata(struct usd_layer *layer, struct usd_text *text);

#endif
