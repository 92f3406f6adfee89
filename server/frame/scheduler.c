#include "server/frame/scheduler.h"

#include <stddef.h>

void scheduler_add_party(struct schedule_party *party)
{
    *party = (struct schedule_party){0};
    for (int c = 0; c < N_CLASSES; c++)
        party->part[c].turn.of = &party->part[c];
}

void scheduler_add_queue(struct schedule_queue *queue, struct schedule_party *party)
{
    *queue = (struct schedule_queue){.party = party};
    TAILQ_INIT(&queue->entries);
    for (int c = 0; c < N_CLASSES; c++) {
        queue->flow[c].queue = queue;
        queue->flow[c].turn.of = &queue->flow[c];
    }
}

static struct schedule_flow *flow_of(const struct schedule_entry *entry)
{
    return &entry->queue->flow[entry->request_class];
}

static struct schedule_part *part_of(const struct schedule_entry *entry)
{
    return &entry->party->part[entry->request_class];
}

/* Charges time to the entry's connection and to its party. */
static void charge(const struct schedule_entry *entry, int64_t us)
{
    turn_charge(&part_of(entry)->turn, us);
    if (entry->queue)
        turn_charge(&flow_of(entry)->turn, us);
}

/* --- entries come and go */

static bool has_begun(const struct schedule_entry *entry)
{
    return entry->state >= SCHEDULE_DRAWING;
}

/* True if the frame has not begun, or is finished but not being sent. */
static bool is_replaceable(const struct schedule_entry *entry)
{
    return entry->has_view && entry->request_class != CLASS_BATCH &&
           (!has_begun(entry) || entry->state == SCHEDULE_HELD);
}

static struct schedule_entry *find_replaced(const struct schedule_queue *queue,
                                            const struct schedule_entry *by)
{
    struct schedule_entry *entry;
    TAILQ_FOREACH (entry, &queue->entries, link)
        if (is_replaceable(entry) && entry->view == by->view)
            return entry;
    return NULL;
}

struct schedule_entry *scheduler_enter(struct scheduler *scheduler, struct schedule_queue *queue,
                                       struct schedule_entry *entry)
{
    struct schedule_entry *replaced = NULL;
    entry->state = SCHEDULE_WAITING;
    if (is_replaceable(entry) && (replaced = find_replaced(queue, entry)))
        scheduler_leave(scheduler, replaced);
    entry->queue = queue;
    entry->party = queue->party;
    TAILQ_INSERT_TAIL(&queue->entries, entry, link);
    struct schedule_flow *flow = flow_of(entry);
    struct schedule_part *part = part_of(entry);
    if (flow->n++ == 0) {
        if (!part->flows.first) {
            struct turns *parts = &scheduler->classes[entry->request_class].parts;
            parts->saved_us = SCHEDULER_SAVED_US;
            turns_join(parts, &part->turn);
        }
        turns_join(&part->flows, &flow->turn);
    }
    scheduler->waiting++;
    return replaced;
}

void scheduler_ready(struct schedule_entry *entry)
{
    entry->state = SCHEDULE_READY;
}

void scheduler_leave(struct scheduler *scheduler, struct schedule_entry *entry)
{
    if (!entry->queue)
        return;
    struct schedule_class *class = &scheduler->classes[entry->request_class];
    struct schedule_flow *flow = flow_of(entry);
    struct schedule_part *part = part_of(entry);
    TAILQ_REMOVE(&entry->queue->entries, entry, link);
    entry->queue->n_held -= entry->state == SCHEDULE_HELD;
    if (--flow->n == 0) {
        turns_leave(&part->flows, &flow->turn);
        if (!part->flows.first)
            turns_leave(&class->parts, &part->turn);
    }
    entry->queue = NULL;
    if (!has_begun(entry)) {
        scheduler->waiting--;
        entry->state = SCHEDULE_OUT;
        return;
    }
    flow->begun--;
    if (entry->state == SCHEDULE_BEGUN || entry->state == SCHEDULE_HELD) {
        class->begun--;
        part->begun--;
        entry->state = SCHEDULE_OUT;
    }
}

void scheduler_finished(struct scheduler *scheduler, struct schedule_entry *entry)
{
    scheduler_leave(scheduler, entry);
    if (has_begun(entry)) {
        scheduler->classes[entry->request_class].begun--;
        part_of(entry)->begun--;
    }
    entry->state = SCHEDULE_OUT;
}

struct schedule_entry *scheduler_hold(struct schedule_entry *entry)
{
    struct schedule_entry *newer = find_replaced(entry->queue, entry);
    entry->state = SCHEDULE_HELD;
    entry->queue->n_held++;
    return newer;
}

/* --- whose turn it is */

/* May another frame of this class begin? When the class has enough frames begun to keep the pool
 * busy, only a party with hardly any may begin another. So nobody is kept out by the frames of
 * others, which may wait for clients that do not read. */
static bool may_begin(const struct schedule_class *class, const struct schedule_part *part)
{
    return class->begun < SCHEDULER_PER_CLASS || part->begun < SCHEDULER_PER_PARTY;
}

/* The flow's entry that may draw now, or NULL. A flow draws one frame at a time, because a frame
 * that begins later can be replaced for longer. No frame begins before an older one that waits: its
 * reply would have to wait for the older one's, while it holds memory that the older one may wait
 * for. */
static struct schedule_entry *drawable(const struct scheduler *scheduler,
                                       const struct schedule_flow *flow,
                                       enum request_class request_class)
{
    bool begins =
        !flow->held && flow->begun < SCHEDULER_PER_QUEUE &&
        may_begin(&scheduler->classes[request_class], &flow->queue->party->part[request_class]);
    struct schedule_entry *first_ready = NULL;
    bool one_waits = false;
    struct schedule_entry *entry;
    TAILQ_FOREACH (entry, &flow->queue->entries, link) {
        if (entry->request_class != request_class)
            continue;
        if (entry->state == SCHEDULE_DRAWING)
            return NULL;
        if (entry->state == SCHEDULE_BEGUN)
            return entry;
        one_waits = one_waits || entry->state == SCHEDULE_WAITING;
        if (entry->state == SCHEDULE_READY && !first_ready && !one_waits)
            first_ready = entry;
    }
    return begins ? first_ready : NULL;
}

/* The context with which both rings of a class are searched. */
struct choice {
    const struct scheduler *scheduler;
    enum request_class request_class;
};

static bool can_flow(const struct turn *turn, void *context)
{
    const struct choice *choice = context;
    return drawable(choice->scheduler, turn->of, choice->request_class) != NULL;
}

static bool can_part(const struct turn *turn, void *context)
{
    const struct schedule_part *part = turn->of;
    const struct turn *flow = part->flows.first;
    do {
        if (can_flow(flow, context))
            return true;
        flow = flow->next;
    } while (flow != part->flows.first);
    return false;
}

static bool can_draw(const struct scheduler *scheduler, enum request_class request_class)
{
    struct choice choice = {scheduler, request_class};
    const struct turn *first = scheduler->classes[request_class].parts.first, *part = first;
    if (!first)
        return false;
    do {
        if (can_part(part, &choice))
            return true;
        part = part->next;
    } while (part != first);
    return false;
}

/* Chooses the party, then its connection. The caller knows that some entry can draw. */
static struct schedule_entry *pick(struct scheduler *scheduler, enum request_class request_class)
{
    struct choice choice = {scheduler, request_class};
    struct turn *turn = turns_next(&scheduler->classes[request_class].parts, can_part, &choice);
    struct schedule_part *part = turn->of;
    turn = turns_next(&part->flows, can_flow, &choice);
    return drawable(scheduler, turn->of, request_class);
}

/* The entry that pick() would choose. */
static const struct schedule_entry *peek(const struct scheduler *scheduler,
                                         enum request_class request_class)
{
    struct choice choice = {scheduler, request_class};
    const struct turn *turn =
        turns_peek(&scheduler->classes[request_class].parts, can_part, &choice);
    const struct schedule_part *part = turn->of;
    turn = turns_peek(&part->flows, can_flow, &choice);
    return drawable(scheduler, turn->of, request_class);
}

/* Books time of the device. Classes that wait are owed their share of it; the class that used it
 * pays all of it from its share, unless no other class wanted the device. */
static void book(struct scheduler *scheduler, enum request_class used_by, int64_t us)
{
    bool waits[N_CLASSES], wanted = false;
    for (int c = 0; c < N_CLASSES; c++) {
        waits[c] = can_draw(scheduler, (enum request_class)c);
        wanted |= waits[c] && c != (int)used_by;
    }
    for (int c = CLASS_STILL; c < N_CLASSES; c++) {
        int64_t *owed = &scheduler->classes[c].owed_us;
        if (c == (int)used_by)
            *owed = wanted ? *owed + us * SCHEDULER_SHARE_PERCENT / 100 - us : 0;
        else if (waits[c])
            *owed += us * SCHEDULER_SHARE_PERCENT / 100;
        else if (*owed > 0)
            *owed = 0;
    }
}

/* Can the class draw a tile for the time that it is owed? If it came earlier, its tile would interrupt every
 * interactive frame of several tiles. */
static bool is_owed_tile(const struct scheduler *scheduler, enum request_class request_class)
{
    int64_t owed = scheduler->classes[request_class].owed_us;
    return owed > 0 && can_draw(scheduler, request_class) &&
           (owed >= SCHEDULER_OWED_US ||
            owed >= (int64_t)peek(scheduler, request_class)->estimate_us);
}

/* The class, stills or batches, that is owed most time, and a tile at least; else N_CLASSES. */
static int owed_class(const struct scheduler *scheduler)
{
    int most = N_CLASSES;
    for (int c = CLASS_STILL; c < N_CLASSES; c++) {
        int64_t owed = scheduler->classes[c].owed_us;
        if (is_owed_tile(scheduler, (enum request_class)c) &&
            (most == N_CLASSES || owed > scheduler->classes[most].owed_us))
            most = c;
    }
    return most;
}

static int next_class(const struct scheduler *scheduler)
{
    int owed = owed_class(scheduler);
    if (owed < N_CLASSES)
        return scheduler->on_device == 0 ? owed : N_CLASSES;
    if (can_draw(scheduler, CLASS_INTERACTIVE))
        return CLASS_INTERACTIVE;
    if (scheduler->on_device > 0)
        return N_CLASSES;
    return can_draw(scheduler, CLASS_STILL)   ? CLASS_STILL
           : can_draw(scheduler, CLASS_BATCH) ? CLASS_BATCH
                                              : N_CLASSES;
}

/* Notes that an interactive tile is given to the device (+1) or leaves it (-1). */
static void set_ahead(struct scheduler *scheduler, const struct schedule_entry *entry, int sign)
{
    if (entry->request_class == CLASS_INTERACTIVE)
        scheduler->ahead_us += (uint64_t)sign * entry->charged_us;
}

struct schedule_entry *scheduler_next(struct scheduler *scheduler)
{
    int c = scheduler->on_device < 2 ? next_class(scheduler) : N_CLASSES;
    if (c == N_CLASSES)
        return NULL;
    /* A request that comes meanwhile may go first, and so may the next tile of the frame that is being
     * drawn: nobody's turn has passed. */
    if (scheduler->ahead_us > 0 &&
        scheduler->ahead_us + peek(scheduler, (enum request_class)c)->estimate_us >
            SCHEDULER_AHEAD_US)
        return NULL;
    struct schedule_entry *entry = pick(scheduler, (enum request_class)c);
    struct schedule_flow *flow = flow_of(entry);
    if (entry->state == SCHEDULE_READY) {
        flow->begun++;
        part_of(entry)->begun++;
        scheduler->classes[c].begun++;
        scheduler->waiting--;
    }
    entry->state = SCHEDULE_DRAWING;
    entry->charged_us = entry->estimate_us;
    set_ahead(scheduler, entry, +1);
    charge(entry, (int64_t)entry->charged_us);
    book(scheduler, entry->request_class, (int64_t)entry->charged_us);
    scheduler->on_device++;
    return entry;
}

void scheduler_put_back(struct scheduler *scheduler, struct schedule_entry *entry)
{
    struct schedule_flow *flow = flow_of(entry);
    scheduler->on_device--;
    set_ahead(scheduler, entry, -1);
    charge(entry, -(int64_t)entry->charged_us);
    book(scheduler, entry->request_class, -(int64_t)entry->charged_us);
    entry->state = SCHEDULE_BEGUN;
    if (entry->has_drawn)
        return;
    entry->state = SCHEDULE_WAITING;
    flow->begun--;
    part_of(entry)->begun--;
    scheduler->classes[entry->request_class].begun--;
    scheduler->waiting++;
}

void scheduler_stepped(struct scheduler *scheduler, struct schedule_entry *entry, uint64_t took_us,
                       bool more)
{
    int64_t missed = (int64_t)took_us - (int64_t)entry->charged_us;
    scheduler->on_device--;
    set_ahead(scheduler, entry, -1);
    scheduler->classes[entry->request_class].spent_us += took_us;
    book(scheduler, entry->request_class, missed);
    charge(entry, missed);
    entry->has_drawn = true;
    entry->state = more && entry->queue ? SCHEDULE_BEGUN : SCHEDULE_ENCODING;
}

void scheduler_resume(struct schedule_entry *entry)
{
    entry->state = SCHEDULE_BEGUN;
}

bool scheduler_is_idle(const struct scheduler *scheduler)
{
    unsigned begun = scheduler->on_device;
    for (int c = 0; c < N_CLASSES; c++)
        begun += scheduler->classes[c].begun;
    return begun == 0;
}
