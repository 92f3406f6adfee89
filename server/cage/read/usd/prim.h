/* The properties of one prim, each with the value that counts. Internal to the USD reader. Any
 * thread. */
#ifndef SHEEN_CAGE_READ_USD_PRIM_H
#define SHEEN_CAGE_READ_USD_PRIM_H

#include "server/cage/read/usd/layer.h"

/* More "xformOp:" properties of one prim, and more entries of an xformOpOrder, are refused. */
#define USD_MAX_OPS 128

struct usd_values {
    const struct usd_prim *prim;
    /* By kind; NULL: the prim does not have it. */
    const struct usd_property *property[N_USD_PROPERTIES];
    const struct usd_property *op[USD_MAX_OPS];
    size_t n_ops;
};

/* Finds a prim's values: of a property that is given twice, a default counts before a sample, and
 * the later before the earlier. False with ERROR_MODEL for too many ops, and for a value that only
 * a spline gives. `values` points into the layer. */
bool usd_find_values(struct usd_values *values, const struct usd_layer *layer,
                     const struct usd_prim *prim);

/* The place of a value; `at` is NULL if the prim does not have it. */
struct usd_text usd_value(const struct usd_values *values, enum usd_property_kind kind);

/* Reads a property that is one of n words, and sets *choice to its number. A prim that does not
 * have it keeps *choice. `all` names the words for the message. */
bool usd_choose(const struct usd_values *values, enum usd_property_kind kind,
                const char *const *words, size_t n, const char *all, size_t *choice);

#endif
