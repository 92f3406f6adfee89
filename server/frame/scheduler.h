/* Which frame draws its next tile: interactive ones first, stills and batches with a fifth of the
 * device's time each as long as they want it. Within a class every party, which is a client's identity,
 * has an equal share of the time, and of its share each of its connections, whatever their frames cost
 * (turns.h).
 *
 * Pure bookkeeping over nodes embedded in their owners: no descriptor, no thread, no clock, no
 * allocation; times are what the owner measured. A frame is an entry: it enters when it is asked
 * for and may be replaced by a newer one of its view until it begins; then it is drawn in steps of
 * one tile, encoded, and leaves. Bounds on what has begun bound the queues of the pool and the
 * memory of finished frames. Thread: one at a time. */
#ifndef SHEEN_FRAME_SCHEDULER_H
#define SHEEN_FRAME_SCHEDULER_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/queue.h>

#include "server/base/turns.h"

enum request_class { CLASS_INTERACTIVE, CLASS_STILL, CLASS_BATCH };
enum { N_CLASSES = 3 };

#define SCHEDULER_PER_QUEUE 2u     /* begun, of a session and class: one draws, one is encoded */
#define SCHEDULER_PER_PARTY 2u     /* begun, of a party and class, however many others have */
#define SCHEDULER_PER_CLASS 8u     /* begun, of a class: keeps the pool busy, no more */
#define SCHEDULER_SHARE_PERCENT 20 /* of the time, for stills and for batches, while they wait */

enum schedule_state {
    SCHEDULE_OUT,      /* in no queue */
    SCHEDULE_WAITING,  /* for a model, an image or memory */
    SCHEDULE_READY,    /* to begin */
    SCHEDULE_DRAWING,  /* a tile is on the device */
    SCHEDULE_BEGUN,    /* between two tiles */
    SCHEDULE_ENCODING, /* the last tile is drawn */
    SCHEDULE_HELD,     /* encoded, until the socket can take it: may still be replaced */
};

struct schedule_queue;

struct schedule_entry {
    /* Set before it enters. */
    enum request_class request_class;
    bool has_view; /* else it neither replaces nor is replaced */
    uint32_t view;
    void *owner;
    uint64_t estimate_us; /* of its next tile; may be changed between steps */

    enum schedule_state state;
    struct schedule_queue *queue; /* NULL once it has left, or its session has */
    struct schedule_party *party; /* its queue's, also after that: until nobody works for it */
    TAILQ_ENTRY(schedule_entry) link;
    uint64_t charged_us; /* for the tile on the device */
    bool has_drawn;      /* a tile */
};

/* A session's part in one class. */
struct schedule_flow {
    struct turn turn; /* among those of its party */
    struct schedule_queue *queue;
    unsigned n, begun; /* entries */
    bool held;         /* the session cannot take more output of this class: begin nothing */
};

struct schedule_queue {                                   /* one per session */
    TAILQ_HEAD(schedule_entries, schedule_entry) entries; /* in the order in which they entered */
    struct schedule_party *party;
    struct schedule_flow flow[N_CLASSES];
};

/* A party's part in one class. */
struct schedule_part {
    struct turn turn;   /* among all parties */
    struct turns flows; /* with entries */
    unsigned begun;     /* counted as that of the class */
};

struct schedule_party { /* one for each identity; outlives its entries */
    struct schedule_part part[N_CLASSES];
};

struct schedule_class {
    struct turns parts; /* with entries */
    unsigned begun;
    int64_t owed_us; /* of its share; the class is served before others while this is above 0 */
    uint64_t spent_us;
};

struct scheduler {
    struct schedule_class classes[N_CLASSES];
    unsigned waiting;   /* entries that have not begun */
    unsigned on_device; /* tiles that scheduler_next() has given out: at most 2 */
};

void scheduler_add_party(struct schedule_party *party);
void scheduler_add_queue(struct schedule_queue *queue, struct schedule_party *party);

/* The entry joins its session's queue, WAITING. Returns the entry of the same view that it
 * replaces, which has left, or NULL. Batches are not replaced and replace nothing. */
struct schedule_entry *scheduler_enter(struct scheduler *scheduler, struct schedule_queue *queue,
                                       struct schedule_entry *entry);
void scheduler_ready(struct schedule_entry *entry); /* WAITING to READY */

/* The next entry to draw a tile of, now DRAWING, or NULL when none may. While one tile is on the
 * device, a second is given out only if it is interactive and no class is owed its share. So an
 * interactive frame waits for at most one tile of another class, and for the shares that are owed. */
struct schedule_entry *scheduler_next(struct scheduler *scheduler);

/* The tile will not be drawn: all is as before scheduler_next(), but that an entry that has not
 * begun is WAITING. */
void scheduler_put_back(struct scheduler *scheduler, struct schedule_entry *entry);

/* The tile has been drawn and took so long. The entry is BEGUN if it has more of them, else
 * ENCODING. It may have left meanwhile. */
void scheduler_stepped(struct scheduler *scheduler, struct schedule_entry *entry, uint64_t took_us,
                       bool more);

/* Something had to be made before its next tile, and is: from ENCODING back to BEGUN. */
void scheduler_resume(struct schedule_entry *entry);

/* ENCODING to HELD. Returns the entry that has asked for the same view since, or NULL: then the
 * frame is worth keeping. */
struct schedule_entry *scheduler_hold(struct schedule_entry *entry);

/* The entry leaves its queue, in whatever state. One that is DRAWING or ENCODING is still counted
 * as begun until scheduler_finished(). */
void scheduler_leave(struct scheduler *scheduler, struct schedule_entry *entry);
/* Nobody works for the entry any more, which has begun. It leaves if it has not. */
void scheduler_finished(struct scheduler *scheduler, struct schedule_entry *entry);

/* Nobody works for any entry. */
bool scheduler_is_idle(const struct scheduler *scheduler);

#endif
