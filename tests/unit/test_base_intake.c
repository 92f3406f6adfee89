/* Which connection's input is handled next. The loop's time is shared equally among parties, and
 * then among each party's sources, whatever each of them sends. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "server/base/intake.h"

enum { PARTIES = 4, SOURCES = 40 };

struct asker {
    struct intake_source source;
    uint64_t cost_us, used_us; /* microseconds: of one message; of all messages handled so far */
};

static void handle(struct intake_source *source)
{
    struct asker *asker = source->owner;
    asker->used_us += asker->cost_us;
}

static void handle_for(struct intake *intake, uint64_t us)
{
    for (uint64_t now_us = 0; now_us < us;) {
        struct intake_source *source = intake_next(intake, 0);
        const struct asker *asker = source->owner;
        source->handle(source);
        intake_charge(source, asker->cost_us);
        now_us += asker->cost_us;
    }
}

static void ask(struct intake *intake, struct asker *asker, struct intake_party *party,
                uint64_t cost_us)
{
    *asker = (struct asker){.cost_us = cost_us};
    intake_add_source(&asker->source, party, handle, asker);
    intake_ask(intake, &asker->source, true);
}

static void test_empty(void **state)
{
    (void)state;
    struct intake intake = {0};
    struct intake_party party;
    struct asker asker;
    assert_null(intake_next(&intake, 0));
    intake_add_party(&party);
    ask(&intake, &asker, &party, 1);
    /* the source has been marked as having input already */
    intake_ask(&intake, &asker.source, true);
    assert_ptr_equal(intake_next(&intake, 0), &asker.source);
    intake_ask(&intake, &asker.source, false);
    intake_ask(&intake, &asker.source, false);
    assert_int_equal(intake_due_us(&intake), UINT64_MAX);
    assert_null(intake_next(&intake, 0));
}

/* Parties of 1 to 40 sources, whose messages cost from 1 to 400 us. */
static void test_shares(void **state)
{
    (void)state;
    static struct asker asker[PARTIES][SOURCES];
    static const unsigned n[PARTIES] = {1, 2, 7, SOURCES};
    struct intake_party party[PARTIES];
    struct intake intake = {0};
    const uint64_t all_us = 4000000;
    srand(7);
    for (int p = 0; p < PARTIES; p++) {
        intake_add_party(&party[p]);
        for (unsigned s = 0; s < n[p]; s++)
            ask(&intake, &asker[p][s], &party[p], (uint64_t)(1 + rand() % 400));
    }
    handle_for(&intake, all_us);
    for (int p = 0; p < PARTIES; p++)
        for (unsigned s = 0; s < n[p]; s++) {
            uint64_t fair = all_us / PARTIES / n[p], used = asker[p][s].used_us;
            assert_in_range(used, fair - 1500, fair + 1500);
        }
}

/* A source that sends a message now and then waits at most for one round, not for everything that
 * others have sent. Rounds in which it had no message are not saved up. */
static void test_rare_ones(void **state)
{
    (void)state;
    static struct asker many[SOURCES];
    struct asker rare;
    struct intake_party greedy, other;
    struct intake intake = {0};
    intake_add_party(&greedy);
    intake_add_party(&other);
    for (int s = 0; s < SOURCES; s++)
        ask(&intake, &many[s], &greedy, 10);
    ask(&intake, &rare, &other, 10);
    intake_ask(&intake, &rare.source, false);
    for (int i = 0; i < 100; i++) {
        uint64_t waited_us = 0;
        handle_for(&intake, 50000);
        for (intake_ask(&intake, &rare.source, true); rare.used_us == 0 && waited_us <= 130;
             waited_us += 10)
            handle_for(&intake, 10);
        assert_true(waited_us <= 130); /* one round of the others, and its own message */
        intake_ask(&intake, &rare.source, false);
        rare.used_us = 0;
    }
    intake_ask(&intake, &rare.source, true);
    rare.used_us = 0;
    handle_for(&intake, 10000);
    assert_in_range(rare.used_us, 5000 - 150, 5000 + 150);
}

/* Sources of the party of strangers move to a known party as soon as their identity is known. */
static void test_moves(void **state)
{
    (void)state;
    struct asker a, b;
    struct intake_party strangers, known;
    struct intake intake = {0};
    intake_add_party(&strangers);
    intake_add_party(&known);
    ask(&intake, &a, &strangers, 10);
    ask(&intake, &b, &strangers, 10);
    intake_move(&intake, &b.source, &known);
    handle_for(&intake, 10000);
    assert_in_range(a.used_us, 4800, 5200);
    assert_in_range(b.used_us, 4800, 5200);
    intake_ask(&intake, &a.source, false);
    assert_null(strangers.sources.first);
    intake_move(&intake, &a.source, &known);
    /* source a moved without any request pending */
    assert_ptr_equal(intake_next(&intake, 0), &b.source);
    intake_ask(&intake, &b.source, false);
    assert_int_equal(intake_due_us(&intake), UINT64_MAX);
}

/* Every message of a party postpones it by 250 us: it has 200 handled at once and then 4,000 a second, and
 * those of another party do not wait. */
static void test_postponed(void **state)
{
    (void)state;
    enum { SECOND_US = 1000000, EACH_US = 250, STEP_US = 10 };
    struct asker many, other;
    struct intake_party greedy, party;
    struct intake intake = {0};
    intake_add_party(&greedy);
    intake_add_party(&party);
    ask(&intake, &many, &greedy, 1);
    ask(&intake, &other, &party, 1);
    unsigned at_once = 0;
    const uint64_t start_us = 77 * (uint64_t)SECOND_US;
    for (uint64_t now_us = start_us; now_us < start_us + SECOND_US; now_us += STEP_US) {
        const struct intake_source *next = intake_next(&intake, now_us);
        assert_non_null(next);
        intake_charge(next->owner == &many ? &many.source : &other.source, 1);
        if (next->owner != &many)
            continue;
        many.used_us++;
        intake_postpone(&greedy, now_us, EACH_US);
        at_once += now_us < start_us + INTAKE_AHEAD_US / 10;
    }
    assert_in_range(many.used_us, SECOND_US / EACH_US + 195, SECOND_US / EACH_US + 205);
    assert_in_range(at_once, 195, 230);

    uint64_t end_us = start_us + SECOND_US;
    intake_ask(&intake, &other.source, false);
    intake_postpone(&greedy, end_us, INTAKE_AHEAD_US);
    uint64_t due_us = intake_due_us(&intake);
    assert_true(due_us > end_us);
    assert_null(intake_next(&intake, due_us - 1));
    assert_ptr_equal(intake_next(&intake, due_us), &many.source);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_empty),     cmocka_unit_test(test_shares),
        cmocka_unit_test(test_rare_ones), cmocka_unit_test(test_moves),
        cmocka_unit_test(test_postponed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
