#include "server/render/gl/programs/kept_programs.h"

#include <assert.h>
#include <pthread.h>
#include <stdlib.h>

static_assert(MAX_KEPT_PROGRAMS >= MAX_FRAME_PROGRAMS, "there is room for each frame");

enum place_state { PLACE_FREE, PLACE_ORDERED, PLACE_MAKING, PLACE_MADE, PLACE_FAILED };

struct place {
    enum place_state state;
    struct program_id id;
    GLuint name;
    bool has_run;         /* in the render thread's context, when drivers generate its code */
    unsigned n_holders;   /* frames that hold it */
    uint64_t asker;       /* whose frame ordered it */
    uint64_t made, used;  /* times of the making and of the last use, by `clock` */
    struct error failure; /* PLACE_FAILED */
};

struct kept_programs {
    pthread_mutex_t lock;
    pthread_cond_t ordered, changed; /* for the maker; for kept_programs_wait() */
    unsigned holders;
    bool is_closed;
    bool is_refused; /* a frame waits for places */
    uint64_t clock;
    uint64_t n_changes, n_waited; /* of what frames wait for; up to the last kept_programs_wait() */
    void (*woken)(void *owner);   /* NULL after the renderer's end */
    void *owner;
    struct place place[MAX_KEPT_PROGRAMS];
};

struct kept_programs *kept_programs_create(void (*woken)(void *owner), void *owner)
{
    struct kept_programs *programs = calloc(1, sizeof *programs);
    if (!programs)
        return NULL;
    pthread_mutex_init(&programs->lock, NULL);
    pthread_cond_init(&programs->ordered, NULL);
    pthread_cond_init(&programs->changed, NULL);
    programs->holders = 1;
    programs->woken = woken;
    programs->owner = owner;
    return programs;
}

/* Unlocks the list, and frees it if nobody holds it. */
static void unlock_one_less(struct kept_programs *programs)
{
    bool is_last = --programs->holders == 0;
    pthread_mutex_unlock(&programs->lock);
    if (!is_last)
        return;
    pthread_cond_destroy(&programs->changed);
    pthread_cond_destroy(&programs->ordered);
    pthread_mutex_destroy(&programs->lock);
    free(programs);
}

void kept_programs_release(struct kept_programs *programs)
{
    if (!programs)
        return;
    pthread_mutex_lock(&programs->lock);
    programs->woken = NULL;
    unlock_one_less(programs);
}

/* Tells frames that they should try again. The lock is held, so that the renderer cannot end during
 * the call. */
static void wake(struct kept_programs *programs)
{
    programs->n_changes++;
    pthread_cond_broadcast(&programs->changed);
    if (programs->woken)
        programs->woken(programs->owner);
}

void kept_programs_wait(struct kept_programs *programs)
{
    pthread_mutex_lock(&programs->lock);
    while (programs->n_changes == programs->n_waited)
        pthread_cond_wait(&programs->changed, &programs->lock);
    programs->n_waited = programs->n_changes;
    pthread_mutex_unlock(&programs->lock);
}

/* --- places */

static struct place *find(struct kept_programs *programs, const struct program_id *id)
{
    for (int i = 0; i < MAX_KEPT_PROGRAMS; i++) {
        struct place *place = &programs->place[i];
        if (place->state != PLACE_FREE && program_id_is_same(&place->id, id))
            return place;
    }
    return NULL;
}

static bool can_be_replaced(const struct place *place, uint64_t now)
{
    return place->state != PLACE_FREE && place->state != PLACE_MAKING && place->n_holders == 0 &&
           place->used < now;
}

/* Returns a free place; removes the program used longest ago if there is none. NULL if all are held,
 * or used at this time. GL thread. */
static struct place *make_room(struct kept_programs *programs)
{
    struct place *oldest = NULL;
    for (int i = 0; i < MAX_KEPT_PROGRAMS; i++) {
        struct place *place = &programs->place[i];
        if (place->state == PLACE_FREE)
            return place;
        if (can_be_replaced(place, programs->clock) && (!oldest || place->used < oldest->used))
            oldest = place;
    }
    if (oldest && oldest->state == PLACE_MADE)
        glDeleteProgram(oldest->name);
    return oldest;
}

static void order(struct kept_programs *programs, struct place *place, const struct program_id *id,
                  uint64_t asker)
{
    *place =
        (struct place){.state = PLACE_ORDERED, .id = *id, .asker = asker, .used = programs->clock};
    pthread_cond_signal(&programs->ordered);
}

/* --- what frames hold */

/* Finds or orders all programs, and marks them as used now. False if there is no room; then what
 * was ordered stays in the list until others need the place. */
static bool gather(struct kept_programs *programs, struct program_hold *hold,
                   const struct program_id *ids, int n, uint64_t asker)
{
    programs->clock++;
    for (int i = 0; i < n; i++) {
        struct place *place = find(programs, &ids[i]);
        if (place)
            place->used = programs->clock;
    }
    hold->n = 0;
    for (int i = 0; i < n; i++) {
        struct place *place = find(programs, &ids[i]);
        if (!place) {
            place = make_room(programs);
            if (!place)
                return false;
            order(programs, place, &ids[i], asker);
        }
        hold->at[hold->n++] = (uint8_t)(place - programs->place);
    }
    return true;
}

static void let_go(struct kept_programs *programs, struct place *place)
{
    if (--place->n_holders > 0)
        return;
    /* Nobody waits for it any more. A failure is told once: the next frame orders again. */
    if (place->state == PLACE_ORDERED || place->state == PLACE_FAILED)
        place->state = PLACE_FREE;
    if (programs->is_refused) {
        programs->is_refused = false;
        wake(programs);
    }
}

void program_hold_end(struct program_hold *hold)
{
    struct kept_programs *programs = hold->programs;
    if (!programs)
        return;
    pthread_mutex_lock(&programs->lock);
    for (int i = 0; i < hold->n; i++)
        let_go(programs, &programs->place[hold->at[i]]);
    *hold = (struct program_hold){0};
    unlock_one_less(programs);
}

static void begin_hold(struct kept_programs *programs, struct program_hold *hold,
                       const struct program_id *ids, int n, uint64_t asker)
{
    if (!gather(programs, hold, ids, n, asker)) {
        programs->is_refused = true;
        return;
    }
    hold->programs = programs;
    programs->holders++;
    for (int i = 0; i < hold->n; i++)
        programs->place[hold->at[i]].n_holders++;
}

static enum hold_state state_of(const struct program_hold *hold, struct error *error)
{
    enum hold_state state = hold->programs ? HOLD_READY : HOLD_WAITS;
    for (int i = 0; hold->programs && i < hold->n; i++) {
        const struct place *place = &hold->programs->place[hold->at[i]];
        if (place->state == PLACE_FAILED) {
            *error = place->failure;
            return HOLD_FAILED;
        }
        if (place->state != PLACE_MADE)
            state = HOLD_WAITS;
    }
    return state;
}

enum hold_state kept_programs_hold(struct kept_programs *programs, struct program_hold *hold,
                                   const struct program_id *ids, int n, uint64_t asker,
                                   struct error *error)
{
    pthread_mutex_lock(&programs->lock);
    if (!hold->programs)
        begin_hold(programs, hold, ids, n, asker);
    programs->n_waited = programs->n_changes;
    enum hold_state state = state_of(hold, error);
    pthread_mutex_unlock(&programs->lock);
    if (state == HOLD_FAILED)
        program_hold_end(hold);
    return state;
}

GLuint kept_programs_find(struct kept_programs *programs, const struct program_id *id,
                          bool *has_run)
{
    pthread_mutex_lock(&programs->lock);
    const struct place *place = find(programs, id);
    GLuint name = place && place->state == PLACE_MADE ? place->name : 0;
    if (has_run)
        *has_run = name && place->has_run;
    pthread_mutex_unlock(&programs->lock);
    return name;
}

void kept_programs_note_run(struct kept_programs *programs, const struct program_id *id)
{
    pthread_mutex_lock(&programs->lock);
    struct place *place = find(programs, id);
    if (place)
        place->has_run = true;
    pthread_mutex_unlock(&programs->lock);
}

void kept_programs_order(struct kept_programs *programs, const struct program_id *id)
{
    pthread_mutex_lock(&programs->lock);
    for (int i = 0; !find(programs, id) && i < MAX_KEPT_PROGRAMS; i++)
        if (programs->place[i].state == PLACE_FREE)
            order(programs, &programs->place[i], id, 0);
    pthread_mutex_unlock(&programs->lock);
}

void kept_programs_forget(struct kept_programs *programs)
{
    pthread_mutex_lock(&programs->lock);
    for (int i = 0; i < MAX_KEPT_PROGRAMS; i++) {
        struct place *place = &programs->place[i];
        place->state = place->n_holders > 0 ? PLACE_ORDERED : PLACE_FREE;
        place->name = 0;
        place->has_run = false;
    }
    pthread_mutex_unlock(&programs->lock);
}

static unsigned count_made(const struct kept_programs *programs)
{
    unsigned n = 0;
    for (int i = 0; i < MAX_KEPT_PROGRAMS; i++)
        n += programs->place[i].state == PLACE_MADE;
    return n;
}

static struct place *oldest_unheld(struct kept_programs *programs)
{
    struct place *oldest = NULL;
    for (int i = 0; i < MAX_KEPT_PROGRAMS; i++) {
        struct place *place = &programs->place[i];
        if (place->state == PLACE_MADE && place->n_holders == 0 &&
            (!oldest || place->used < oldest->used))
            oldest = place;
    }
    return oldest;
}

void kept_programs_drop(struct kept_programs *programs, unsigned most)
{
    struct place *place;
    pthread_mutex_lock(&programs->lock);
    while (count_made(programs) > most && (place = oldest_unheld(programs))) {
        glDeleteProgram(place->name);
        *place = (struct place){.state = PLACE_FREE};
    }
    pthread_mutex_unlock(&programs->lock);
}

unsigned kept_programs_count(struct kept_programs *programs)
{
    pthread_mutex_lock(&programs->lock);
    unsigned n = count_made(programs);
    pthread_mutex_unlock(&programs->lock);
    return n;
}

/* --- the maker */

/* When the asker's latest program was made; 0: it has none in the list. */
static uint64_t last_made_for(const struct kept_programs *programs, uint64_t asker)
{
    uint64_t last = 0;
    for (int i = 0; i < MAX_KEPT_PROGRAMS; i++) {
        const struct place *place = &programs->place[i];
        if (place->asker == asker && place->made > last)
            last = place->made;
    }
    return last;
}

/* The next order: one that a frame waits for, of the asker for whom nothing was made for longest;
 * else one of kept_programs_order(). NULL: none. */
static struct place *next_order(struct kept_programs *programs)
{
    struct place *next = NULL;
    uint64_t next_last = 0;
    for (int i = 0; i < MAX_KEPT_PROGRAMS; i++) {
        struct place *place = &programs->place[i];
        if (place->state != PLACE_ORDERED)
            continue;
        uint64_t last = place->n_holders > 0 ? last_made_for(programs, place->asker) : UINT64_MAX;
        if (next && last >= next_last)
            continue;
        next = place;
        next_last = last;
    }
    return next;
}

bool kept_programs_take_order(struct kept_programs *programs, struct program_id *id, int *at)
{
    struct place *place = NULL;
    pthread_mutex_lock(&programs->lock);
    while (!programs->is_closed && !(place = next_order(programs)))
        pthread_cond_wait(&programs->ordered, &programs->lock);
    if (place) {
        place->state = PLACE_MAKING;
        place->made = ++programs->clock;
        *id = place->id;
        *at = (int)(place - programs->place);
    }
    pthread_mutex_unlock(&programs->lock);
    return place;
}

void kept_programs_finish_order(struct kept_programs *programs, int at, GLuint name,
                                const struct error *error)
{
    struct place *place = &programs->place[at];
    pthread_mutex_lock(&programs->lock);
    place->name = name;
    place->state = name                   ? PLACE_MADE
                   : place->n_holders > 0 ? PLACE_FAILED
                                          : PLACE_FREE; /* nobody is left who needs the reason */
    if (!name)
        place->failure = *error;
    wake(programs);
    pthread_mutex_unlock(&programs->lock);
}

static void set_closed(struct kept_programs *programs, bool is_closed)
{
    pthread_mutex_lock(&programs->lock);
    programs->is_closed = is_closed;
    pthread_cond_broadcast(&programs->ordered);
    pthread_mutex_unlock(&programs->lock);
}

void kept_programs_close(struct kept_programs *programs)
{
    set_closed(programs, true);
}

void kept_programs_open(struct kept_programs *programs)
{
    set_closed(programs, false);
}
