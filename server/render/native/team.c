#include "server/render/native/team.h"

#include <pthread.h>
#include <signal.h>
#include <stdlib.h>

struct member {
    struct native_team *team;
    unsigned number;
    pthread_t thread;
};

struct native_team {
    struct member *member; /* the first is the caller's */
    unsigned n_threads;
    pthread_mutex_t mutex;
    pthread_cond_t begins, all_here;
    void (*work)(void *owner, unsigned number);
    void *owner;
    unsigned long n_runs, n_meetings; /* runs begun; meetings ended */
    unsigned n_here;                  /* threads that wait for the others */
    bool breaks_up;
};

/* About 20 microseconds: most waits within a frame are shorter, and to be woken by the kernel takes longer. */
enum { LOOKS = 1000 };

/* Waits a moment for a counter to change, without the mutex. */
static void look_at(const unsigned long *counter, unsigned long before)
{
    for (int i = 0; i < LOOKS && __atomic_load_n(counter, __ATOMIC_RELAXED) == before; i++) {
#if defined(__x86_64__)
        __builtin_ia32_pause();
#endif
    }
}

static void advance(unsigned long *counter)
{
    __atomic_fetch_add(counter, 1, __ATOMIC_RELAXED);
}

/* The last thread to arrive wakes all others. */
static void meet(struct native_team *team)
{
    pthread_mutex_lock(&team->mutex);
    unsigned long meeting = team->n_meetings;
    bool is_last = ++team->n_here == team->n_threads;
    if (is_last) {
        team->n_here = 0;
        advance(&team->n_meetings);
        pthread_cond_broadcast(&team->all_here);
    }
    pthread_mutex_unlock(&team->mutex);
    if (is_last)
        return;
    look_at(&team->n_meetings, meeting);
    pthread_mutex_lock(&team->mutex);
    while (team->n_meetings == meeting)
        pthread_cond_wait(&team->all_here, &team->mutex);
    pthread_mutex_unlock(&team->mutex);
}

/* False if the team breaks up instead. */
static bool await_run(struct native_team *team, unsigned long n_done)
{
    look_at(&team->n_runs, n_done);
    pthread_mutex_lock(&team->mutex);
    while (team->n_runs == n_done && !team->breaks_up)
        pthread_cond_wait(&team->begins, &team->mutex);
    bool begins = !team->breaks_up;
    pthread_mutex_unlock(&team->mutex);
    return begins;
}

static void *serve(void *argument)
{
    const struct member *member = argument;
    struct native_team *team = member->team;
    for (unsigned long n_done = 0; await_run(team, n_done); n_done++) {
        team->work(team->owner, member->number);
        meet(team);
    }
    return NULL;
}

/* Signals are handled by the program's other threads. */
static bool start_member(struct member *member)
{
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    int failed = pthread_create(&member->thread, NULL, serve, member);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return !failed;
}

struct native_team *native_team_create(unsigned n_threads)
{
    struct native_team *team = calloc(1, sizeof *team);
    if (!team)
        return NULL;
    pthread_mutex_init(&team->mutex, NULL);
    pthread_cond_init(&team->begins, NULL);
    pthread_cond_init(&team->all_here, NULL);
    team->member = calloc(n_threads, sizeof *team->member);
    team->n_threads = team->member ? 1 : 0;
    for (; team->n_threads > 0 && team->n_threads < n_threads; team->n_threads++) {
        struct member *member = &team->member[team->n_threads];
        *member = (struct member){.team = team, .number = team->n_threads};
        if (!start_member(member))
            break;
    }
    if (team->n_threads == n_threads)
        return team;
    native_team_destroy(team);
    return NULL;
}

void native_team_destroy(struct native_team *team)
{
    if (!team)
        return;
    pthread_mutex_lock(&team->mutex);
    team->breaks_up = true;
    pthread_cond_broadcast(&team->begins);
    pthread_mutex_unlock(&team->mutex);
    for (unsigned i = 1; i < team->n_threads; i++)
        pthread_join(team->member[i].thread, NULL);
    pthread_cond_destroy(&team->all_here);
    pthread_cond_destroy(&team->begins);
    pthread_mutex_destroy(&team->mutex);
    free(team->member);
    free(team);
}

void native_team_run(struct native_team *team, void (*work)(void *owner, unsigned number),
                     void *owner)
{
    pthread_mutex_lock(&team->mutex);
    team->work = work;
    team->owner = owner;
    advance(&team->n_runs);
    pthread_cond_broadcast(&team->begins);
    pthread_mutex_unlock(&team->mutex);
    work(owner, 0);
    native_team_meet(team);
}

void native_team_meet(struct native_team *team)
{
    meet(team);
}
