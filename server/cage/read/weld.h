/* Joining vertices that stand at the same place. Internal to the glTF reader, whose files split
 * vertices where normals or texture coordinates differ. */
#ifndef SHEEN_CAGE_READ_WELD_H
#define SHEEN_CAGE_READ_WELD_H

#include "server/cage/read/builder.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Makes one vertex of all with exactly equal coordinates, in the order of their first; linear in
 * the size of the cage. Corners that fall together leave their face, faces and creases left with
 * too few are dropped, both with a warning; a corner that the file itself repeats stays for
 * cage_check(). All vertex indices must be in range. ERROR_SERVER when memory is short. */
bool cage_weld(struct cage_builder *builder, const char *name, struct error *error);

#ifdef __cplusplus
}
#endif

#endif
