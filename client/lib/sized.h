/* Copies structs of sheen.h that begin with `size` between this library and programs compiled with
 * an older or newer sheen.h, by the rules of "Compatibility" there. Pure, any thread. */
#ifndef SHEEN_CLIENT_SIZED_H
#define SHEEN_CLIENT_SIZED_H

#include "client/lib/sheen.h"

/* Checks the program's struct: SHEEN_BAD_ARGUMENT if `theirs` is NULL, or if its size is below 16
 * or above 1 MiB, as when the program has not set it. `name` is the struct's name for the error. */
enum sheen_status sized_check(const void *theirs, const char *name, struct sheen_error *error);

/* sized_check(), then copies the program's struct into *ours, which has n_ours bytes and must hold
 * the defaults. Then ours->size is n_ours. SHEEN_BAD_ARGUMENT if the program sets members
 * that this library does not have. */
enum sheen_status sized_take(void *ours, size_t n_ours, const void *theirs, const char *name,
                             struct sheen_error *error);

/* Copies *ours, of n_ours bytes, into the program's struct, which has passed sized_check(), and
 * zeroes the members that this library does not have. Its size stays. */
void sized_give(void *theirs, const void *ours, size_t n_ours);

#endif
