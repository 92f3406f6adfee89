/* The scheduler decides which frame draws its next tile. Interactive frames come first, but while
 * stills or batches wait, each of these two classes gets a fifth of the device's time. Within a
 * class every party (a client's identity) has an equal share of the time, and within a party every
 * connection, however expensive their frames are (turns.h).
 *
 * A frame is an entry. It enters the queue when it is requested; until it begins to be drawn, a
 * newer frame of the same view may replace it. Then it is drawn tile by tile, encoded, and leaves.
 * The number of frames that have begun is bounded, which bounds the pool's queue and the memory of
 * finished frames.
 *
 * Plain data, embedded in the structs of its users: no file descriptor, no thread, no clock, no
 * allocation. Times are measured by the caller.
 * Thread: one at a time. */
#ifndef SHEEN_FRAME_SCHEDULER_H
#define SHEEN_FRAME_SCHEDULER_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/queue.h>

#include "server/base/turns.h"

enum request_class { CLASS_INTERACTIVE, CLASS_STILL, CLASS_BATCH };
enum { N_CLASSES = 3 };

/* Frames begun of one session and class: one is drawn while another is encoded. */
#define SCHEDULER_PER_QUEUE 2u
#define SCHEDULER_PER_PARTY 2u /* frames begun of one party and class that are always allowed */
#define SCHEDULER_PER_CLASS 8u /* frames begun of one class: enough to keep the pool busy */
/* Two interactive tiles are on the device at once only if both together take no longer than this. So a
 * new request waits no longer, unless a single tile takes longer. */
#define SCHEDULER_AHEAD_US 4000
/* A party that has used less than its share draws for so long without a break: a frame of several
 * tiles does not wait before each of them for a tile of another party. */
#define SCHEDULER_SAVED_US 32000
/* The share of the device's time that stills, and also batches, get while they wait. */
#define SCHEDULER_SHARE_PERCENT 20
/* A class of which less is owed waits until a whole tile is owed to it. */
#define SCHEDULER_OWED_US 10000

enum schedule_state {
    SCHEDULE_OUT,      /* in no queue */
    SCHEDULE_WAITING,  /* waits for a model, an image or memory */
    SCHEDULE_READY,    /* may begin */
    SCHEDULE_DRAWING,  /* a tile is on the device */
    SCHEDULE_BEGUN,    /* between two tiles */
    SCHEDULE_ENCODING, /* the last tile is drawn */
    SCHEDULE_HELD,     /* encoded; waits for the socket, and may still be replaced */
};

struct schedule_queue;

struct schedule_entry {
    /* Set these before scheduler_enter(). */
    enum request_class request_class;
    bool has_view; /* false: the entry neither replaces another nor is replaced */
    uint32_t view;
    void *owner;
    uint64_t estimate_us; /* expected time of the next tile; may be changed between tiles */

    enum schedule_state state;
    struct schedule_queue *queue; /* NULL after the entry or its session has left */
    struct schedule_party *party; /* the queue's party; valid until scheduler_finished() */
    TAILQ_ENTRY(schedule_entry) link;
    uint64_t charged_us; /* charged in advance for the tile on the device */
    bool has_drawn;      /* at least one tile was drawn */
};

/* What a session has in one class. */
struct schedule_flow {
    struct turn turn; /* its turn among the sessions of its party */
    struct schedule_queue *queue;
    unsigned n, begun; /* number of entries; of those, how many have begun */
    bool held;         /* the session's socket is busy: begin no frame of this class */
};

struct schedule_queue {                                   /* one per session */
    TAILQ_HEAD(schedule_entries, schedule_entry) entries; /* in order of entering */
    struct schedule_party *party;
    unsigned n_held; /* entries in state HELD */
    struct schedule_flow flow[N_CLASSES];
};

/* What a party has in one class. */
struct schedule_part {
    struct turn turn;   /* its turn among the parties */
    struct turns flows; /* with entries */
    unsigned begun;     /* frames begun, as in struct schedule_class */
};

struct schedule_party { /* one for each identity; outlives its entries */
    struct schedule_part part[N_CLASSES];
};

struct schedule_class {
    struct turns parts; /* with entries */
    unsigned begun;
    /* The part of its share that it has not had; while above 0 the class is served first. */
    int64_t owed_us;
    uint64_t spent_us;
};

struct scheduler {
    struct schedule_class classes[N_CLASSES];
    unsigned waiting;   /* number of entries that have not begun */
    unsigned on_device; /* tiles being drawn: at most 2 */
    uint64_t ahead_us;  /* expected time of the interactive tiles among them */
};

void scheduler_add_party(struct schedule_party *party);
void scheduler_add_queue(struct schedule_queue *queue, struct schedule_party *party);

/* Adds an entry to its session's queue, in state WAITING. If it replaces an older entry of the same
 * view, that one leaves and is returned; else NULL. Batches neither replace nor are replaced. */
struct schedule_entry *scheduler_enter(struct scheduler *scheduler, struct schedule_queue *queue,
                                       struct schedule_entry *entry);
void scheduler_ready(struct schedule_entry *entry); /* moves from WAITING to READY */

/* Chooses the entry whose next tile is to be drawn, and moves it to DRAWING. NULL if none may draw.
 * While one tile is on the device, a second one is given out only if it is interactive, no other class
 * is owed time, and two interactive tiles take no longer than SCHEDULER_AHEAD_US. So an interactive
 * frame waits for at most one tile of another class, plus the time owed, and one tile of another
 * party. */
struct schedule_entry *scheduler_next(struct scheduler *scheduler);

/* Undoes scheduler_next(), because the tile will not be drawn now. An entry that had not drawn a
 * tile becomes WAITING. */
void scheduler_put_back(struct scheduler *scheduler, struct schedule_entry *entry);

/* Reports that the tile is drawn and took took_us. The entry becomes BEGUN if it has more tiles,
 * else ENCODING. It may have left in the meantime. */
void scheduler_stepped(struct scheduler *scheduler, struct schedule_entry *entry, uint64_t took_us,
                       bool more);

/* Moves an entry from ENCODING back to BEGUN: the polygons that its next tile needs are there. */
void scheduler_resume(struct schedule_entry *entry);

/* Moves an entry from ENCODING to HELD. Returns a newer entry of the same view if there is one:
 * then the held frame is obsolete. Else NULL. */
struct schedule_entry *scheduler_hold(struct schedule_entry *entry);

/* The entry leaves its queue. If it is DRAWING or ENCODING, it still counts as begun until
 * scheduler_finished(). */
void scheduler_leave(struct scheduler *scheduler, struct schedule_entry *entry);
/* No thread works for the entry any more: it stops counting as begun, and leaves if it has not
 * yet. */
void scheduler_finished(struct scheduler *scheduler, struct schedule_entry *entry);

/* True if no entry is being drawn or encoded, and none is held. */
bool scheduler_is_idle(const struct scheduler *scheduler);

#endif
