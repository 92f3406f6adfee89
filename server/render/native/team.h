/* Threads that work on one thing together: the caller is one of them. */
#ifndef SHEEN_RENDER_NATIVE_TEAM_H
#define SHEEN_RENDER_NATIVE_TEAM_H

#include <stdbool.h>

struct native_team;

/* NULL when threads or memory are short. */
struct native_team *native_team_create(unsigned n_threads);
void native_team_destroy(struct native_team *team); /* NULL is safe */

/* Every thread of the team calls work(owner, its number), 0 for the caller; returns when all have
 * come back. One call at a time. */
void native_team_run(struct native_team *team, void (*work)(void *owner, unsigned number),
                     void *owner);
/* Inside work(): waits until all of the team have come here. */
void native_team_meet(struct native_team *team);

#endif
