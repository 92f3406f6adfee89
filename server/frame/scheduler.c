#include "server/frame/scheduler.h"

#include <stddef.h>

void scheduler_add_queue(struct schedule_queue *queue)
{
    *queue = (struct schedule_queue){0};
    TAILQ_INIT(&queue->entries);
    for (int c = 0; c < N_CLASSES; c++)
        queue->flow[c].queue = queue;
}

static struct schedule_flow *flow_of(const struct schedule_entry *entry)
{
    return &entry->queue->flow[entry->request_class];
}

/* --- the ring of flows that have entries */

static void link_flow(struct schedule_class *class, struct schedule_flow *flow)
{
    if (!class->turn) {
        flow->next = flow->previous = class->turn = flow;
        return;
    }
    flow->next = class->turn; /* last in the round */
    flow->previous = class->turn->previous;
    flow->previous->next = flow;
    flow->next->previous = flow;
}

static void unlink_flow(struct schedule_class *class, struct schedule_flow *flow)
{
    flow->previous->next = flow->next;
    flow->next->previous = flow->previous;
    if (class->turn == flow)
        class->turn = flow->next == flow ? NULL : flow->next;
}

/* Brings a flow's deficit up to the class's round. A session that asks for little cannot save up;
 * one that has used ahead pays it back, also while it has nothing to ask. */
static void settle(const struct schedule_class *class, struct schedule_flow *flow)
{
    uint64_t rounds = class->round - flow->round;
    int64_t most = SCHEDULER_QUANTUM_US;
    flow->round = class->round;
    flow->deficit_us = rounds > UINT32_MAX ? most : flow->deficit_us + (int64_t)rounds * most;
    if (flow->deficit_us > most)
        flow->deficit_us = most;
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
    TAILQ_INSERT_TAIL(&queue->entries, entry, link);
    struct schedule_flow *flow = flow_of(entry);
    if (flow->n++ == 0)
        link_flow(&scheduler->classes[entry->request_class], flow);
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
    TAILQ_REMOVE(&entry->queue->entries, entry, link);
    if (--flow->n == 0)
        unlink_flow(class, flow);
    entry->queue = NULL;
    if (!has_begun(entry)) {
        scheduler->waiting--;
        entry->state = SCHEDULE_OUT;
        return;
    }
    flow->begun--;
    if (entry->state == SCHEDULE_BEGUN || entry->state == SCHEDULE_HELD) {
        class->begun--;
        entry->state = SCHEDULE_OUT;
    }
}

void scheduler_finished(struct scheduler *scheduler, struct schedule_entry *entry)
{
    scheduler_leave(scheduler, entry);
    if (has_begun(entry))
        scheduler->classes[entry->request_class].begun--;
    entry->state = SCHEDULE_OUT;
}

struct schedule_entry *scheduler_hold(struct schedule_entry *entry)
{
    struct schedule_entry *newer = find_replaced(entry->queue, entry);
    entry->state = SCHEDULE_HELD;
    return newer;
}

/* --- whose turn it is */

/* The flow's entry that may draw now, or NULL. It draws one frame after the other: what begins late
 * may be replaced until then. No other begins before one that waits: its answer would stand behind
 * that one's, and its memory be what the other waits for. */
static struct schedule_entry *drawable(const struct scheduler *scheduler,
                                       const struct schedule_flow *flow,
                                       enum request_class request_class)
{
    bool may_begin = !flow->held && flow->begun < SCHEDULER_PER_QUEUE &&
                     scheduler->classes[request_class].begun < SCHEDULER_PER_CLASS;
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
    return may_begin ? first_ready : NULL;
}

static bool can_draw(const struct scheduler *scheduler, enum request_class request_class)
{
    const struct schedule_flow *first = scheduler->classes[request_class].turn, *flow = first;
    if (!first)
        return false;
    do {
        if (drawable(scheduler, flow, request_class))
            return true;
        flow = flow->next;
    } while (flow != first);
    return false;
}

/* One pass over the flows: the first that has something left of its round. If none has,
 * *rounds_short says how many rounds it takes until one has. */
static struct schedule_entry *pass(struct scheduler *scheduler, enum request_class request_class,
                                   uint64_t *rounds_short)
{
    struct schedule_class *class = &scheduler->classes[request_class];
    struct schedule_flow *first = class->turn, *flow = first;
    *rounds_short = UINT64_MAX;
    do {
        struct schedule_entry *entry = drawable(scheduler, flow, request_class);
        if (entry) {
            settle(class, flow);
            if (flow->deficit_us > 0) {
                class->turn = flow;
                return entry;
            }
            uint64_t rounds = (uint64_t)-flow->deficit_us / SCHEDULER_QUANTUM_US + 1;
            *rounds_short = rounds < *rounds_short ? rounds : *rounds_short;
        }
        flow = flow->next;
    } while (flow != first);
    return NULL;
}

/* There is one that can draw. */
static struct schedule_entry *pick(struct scheduler *scheduler, enum request_class request_class)
{
    struct schedule_class *class = &scheduler->classes[request_class];
    uint64_t rounds_short;
    struct schedule_entry *entry = pass(scheduler, request_class, &rounds_short);
    if (entry)
        return entry;
    class->round += rounds_short;
    return pass(scheduler, request_class, &rounds_short);
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
        scheduler->classes[c].begun++;
        scheduler->waiting--;
    }
    entry->state = SCHEDULE_DRAWING;
    entry->charged_us = entry->estimate_us;
    flow->deficit_us -= (int64_t)entry->charged_us;
    book(scheduler, entry->request_class, (int64_t)entry->charged_us);
    scheduler->on_device++;
    return entry;
}

void scheduler_put_back(struct scheduler *scheduler, struct schedule_entry *entry)
{
    struct schedule_flow *flow = flow_of(entry);
    scheduler->on_device--;
    flow->deficit_us += (int64_t)entry->charged_us;
    book(scheduler, entry->request_class, -(int64_t)entry->charged_us);
    entry->state = SCHEDULE_BEGUN;
    if (entry->has_drawn)
        return;
    entry->state = SCHEDULE_WAITING;
    flow->begun--;
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
    if (entry->queue)
        flow_of(entry)->deficit_us -= missed;
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
