/* Structs of sheen.h that begin with their size, between this library and programs that were
 * compiled with an older or a newer sheen.h: the rules stand there under "Growth". Pure, any
 * thread. */
#ifndef SHEEN_CLIENT_SIZED_H
#define SHEEN_CLIENT_SIZED_H

#include "client/lib/sheen.h"

/* SHEEN_BAD_ARGUMENT when `theirs` is NULL or its size is below 16 or above 1 MiB, as where the
 * program has not set it. `name` is what error texts call the struct. */
enum sheen_status sized_check(const void *theirs, const char *name, struct sheen_error *error);

/* sized_check(), then moves what the program gives into *ours, of n_ours bytes, which holds the
 * defaults before and has its own size after. SHEEN_BAD_ARGUMENT when the program sets members that
 * this library does not know. */
enum sheen_status sized_take(void *ours, size_t n_ours, const void *theirs, const char *name,
                             struct sheen_error *error);

/* Moves *ours, of n_ours bytes, into the program's struct, which sized_check() has passed, and
 * zeroes what this library does not know of it. Its size stays. */
void sized_give(void *theirs, const void *ours, size_t n_ours);

#endif
