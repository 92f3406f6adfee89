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

/* Books time against the entry's connection and its party. */
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

/* Not begun yet, or done and not on its way. */
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
        if (!part->flows.first)
            turns_join(&scheduler->classes[entry->request_class].parts, &part->turn);
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
    return newer;
}

/* --- whose turn it is */

/* May another frame of this class begin? Where as many have begun as keep the pool busy, only one of a
 * party that has hardly any: nobody is kept out by the frames of others, which may wait for sockets
 * that are not read. */
static bool may_begin(const struct schedule_class *class, const struct schedule_part *part)
{
    return class->begun < SCHEDULER_PER_CLASS || part->begun < SCHEDULER_PER_PARTY;
}

/* The flow's entry that may draw now, or NULL. It draws one frame after the other: what begins late
 * may be replaced until then. No other begins before one that waits: its answer would stand behind
 * that one's, and its memory be what the other waits for. */
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

/* What the two rings of a class are asked with. */
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

/* There is one that can draw: first a party has its turn, then one of its connections. */
static struct schedule_entry *pick(struct scheduler *scheduler, enum request_class request_class)
{
    struct choice choice = {scheduler, request_class};
    struct turn *turn = turns_next(&scheduler->classes[request_class].parts, can_part, &choice);
    struct schedule_part *part = turn->of;
    turn = turns_next(&part->flows, can_flow, &choice);
    return drawable(scheduler, turn->of, request_class);
}

/* Books time of the device: a part of it to those that wait for their share, all of it against the
 * share of the class that used it, unless nobody else wanted it. */
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

/* Stills or batches that have waited for their share, else N_CLASSES. */
static int owed_class(const struct scheduler *scheduler)
{
    int most = N_CLASSES;
    for (int c = CLASS_STILL; c < N_CLASSES; c++) {
        int64_t owed = scheduler->classes[c].owed_us;
        if (owed > 0 && can_draw(scheduler, (enum request_class)c) &&
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

struct schedule_entry *scheduler_next(struct scheduler *scheduler)
{
    int c = scheduler->on_device < 2 ? next_class(scheduler) : N_CLASSES;
    if (c == N_CLASSES)
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
    charge(entry, (int64_t)entry->charged_us);
    book(scheduler, entry->request_class, (int64_t)entry->charged_us);
    scheduler->on_device++;
    return entry;
}

void scheduler_put_back(struct scheduler *scheduler, struct schedule_entry *entry)
{
    struct schedule_flow *flow = flow_of(entry);
    scheduler->on_device--;
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
