/* Files to cages: the one door to the readers beside it. sheend itself never opens it: its worker
 * process sheend-cage does. Any thread. */
#ifndef SHEEN_CAGE_READ_READ_H
#define SHEEN_CAGE_READ_READ_H

#include "server/cage/cage.h"

/* Reads a cage from the bytes of a file. `name` is used to choose the format (.obj, .gltf, .glb;
 * the content decides when the name has no known ending) and in messages. The result has passed
 * cage_check(). On failure *cage is empty and needs no cage_finish(). */
bool cage_read(struct cage *cage, const void *bytes, size_t size, const char *name,
               struct error *error);

#endif
