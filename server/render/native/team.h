/* A team of threads that work together; the calling thread is one of them. */
#ifndef SHEEN_RENDER_NATIVE_TEAM_H
#define SHEEN_RENDER_NATIVE_TEAM_H

#include <stdbool.h>

struct native_team;

/* NULL when threads or memory are short. The thread that creates a team runs and destroys it. */
struct native_team *native_team_create(unsigned n_threads);
void native_team_destroy(struct native_team *team); /* NULL is safe */

/* Calls work(owner, number), with `owner` as given, on every thread of the team, with number 0 for the caller; returns
 * when all have finished. One call at a time. */
void native_team_run(struct native_team *team, void (*work)(void *owner, unsigned number),
                     void *owner);
/* Call it inside of work(): waits until all threads of the team have called it. */
void native_team_meet(struct native_team *team);

#endif
