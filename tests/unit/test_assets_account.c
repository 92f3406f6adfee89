/* The tree of memory accounts against plain sums, and the order in which owners are visited when
 * room must be made. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/assets/client_quota.h"
#include "server/assets/store_shares.h"

enum { N_MIDDLE = 5, N_LEAVES = 4, N_CHARGES = 300, STEPS = 20000 };
#define ROOT_LIMIT 100000u

struct charge {
    int middle, leaf; /* leaf -1: charged to the middle account itself */
    enum account_class class;
    uint64_t bytes; /* 0: this charge is not in use */
};

struct tree {
    struct account root, middle[N_MIDDLE], leaf[N_MIDDLE][N_LEAVES];
    struct charge charges[N_CHARGES];
};

static uint32_t next_random(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return *state >> 8;
}

static void tree_init(struct tree *tree)
{
    memset(tree, 0, sizeof *tree);
    account_init(&tree->root, NULL, ROOT_LIMIT);
    for (int m = 0; m < N_MIDDLE; m++) {
        account_init(&tree->middle[m], &tree->root,
                     m == 0 ? ACCOUNT_NO_LIMIT : ROOT_LIMIT / N_MIDDLE);
        for (int l = 0; l < N_LEAVES; l++)
            account_init(&tree->leaf[m][l], &tree->middle[m], ACCOUNT_NO_LIMIT);
    }
}

static struct account *account_of(struct tree *tree, const struct charge *charge)
{
    return charge->leaf < 0 ? &tree->middle[charge->middle]
                            : &tree->leaf[charge->middle][charge->leaf];
}

/* The plain sum of charges. middle -1 or leaf -1 means those of every middle or leaf account, class
 * -1 those of every class. */
static uint64_t sum_of(const struct tree *tree, int middle, int leaf, int class)
{
    uint64_t sum = 0;
    for (int i = 0; i < N_CHARGES; i++) {
        const struct charge *c = &tree->charges[i];
        if ((middle < 0 || c->middle == middle) && (leaf < 0 || c->leaf == leaf) &&
            (class < 0 || (int)c->class == class))
            sum += c->bytes;
    }
    return sum;
}

static void expect_sums(const struct tree *tree, const struct account *account, int middle,
                        int leaf)
{
    for (int c = 0; c < N_ACCOUNT_CLASSES; c++)
        assert_int_equal(account->used[c], sum_of(tree, middle, leaf, c));
    uint64_t sum = sum_of(tree, middle, leaf, -1);
    assert_int_equal(account_used(account), sum);
    assert_int_equal(account_room(account), account->limit > sum ? account->limit - sum : 0);
}

static void expect_all_sums(const struct tree *tree)
{
    expect_sums(tree, &tree->root, -1, -1);
    for (int m = 0; m < N_MIDDLE; m++) {
        expect_sums(tree, &tree->middle[m], m, -1);
        for (int l = 0; l < N_LEAVES; l++)
            expect_sums(tree, &tree->leaf[m][l], m, l);
    }
}

/* Charges at random while all levels have room by the plain sums, refunds whole charges or parts,
 * and moves charges between accounts. */
static void test_sums(void **state)
{
    (void)state;
    static struct tree tree;
    uint32_t seed = 1;
    unsigned n_refused = 0, n_charged = 0;
    tree_init(&tree);
    for (int step = 0; step < STEPS; step++) {
        struct charge *charge = &tree.charges[next_random(&seed) % N_CHARGES];
        if (charge->bytes == 0) {
            const struct charge wanted = {
                .middle = (int)(next_random(&seed) % N_MIDDLE),
                .leaf = (int)(next_random(&seed) % (N_LEAVES + 1)) - 1,
                .class = next_random(&seed) % N_ACCOUNT_CLASSES,
                .bytes = 1 + next_random(&seed) % 1500,
            };
            uint64_t middle_sum = sum_of(&tree, wanted.middle, -1, -1);
            bool fits = wanted.bytes <= ROOT_LIMIT - sum_of(&tree, -1, -1, -1) &&
                        (wanted.middle == 0 ||
                         middle_sum + wanted.bytes <= tree.middle[wanted.middle].limit);
            assert_true(fits == (wanted.bytes <= account_room(&tree.root) &&
                                 wanted.bytes <= account_room(&tree.middle[wanted.middle])));
            n_refused += !fits;
            n_charged += fits;
            if (!fits)
                continue;
            *charge = wanted;
            account_charge(account_of(&tree, charge), charge->class, charge->bytes);
        } else if (next_random(&seed) % 3 == 0) { /* a charge moves when an upload becomes an
                                                   * asset */
            account_refund(account_of(&tree, charge), charge->class, charge->bytes);
            charge->leaf = (int)(next_random(&seed) % N_LEAVES);
            charge->class = ACCOUNT_ASSETS;
            account_charge(account_of(&tree, charge), charge->class, charge->bytes);
        } else {
            uint64_t part = next_random(&seed) % 2 ? charge->bytes : charge->bytes / 2;
            account_refund(account_of(&tree, charge), charge->class, part);
            charge->bytes -= part;
        }
        if (step % 16 == 0)
            expect_all_sums(&tree);
    }
    assert_true(n_refused > 100 && n_charged > 1000);
    for (int i = 0; i < N_CHARGES; i++) {
        struct charge *charge = &tree.charges[i];
        account_refund(account_of(&tree, charge), charge->class, charge->bytes);
        charge->bytes = 0;
    }
    expect_all_sums(&tree);
}

/* Two connections of one identity share a quota, which is below the daemon's account. Identities
 * are told apart by `owner` and not by name, because two authorities may sign the same name. */
static void test_quotas(void **state)
{
    (void)state;
    struct account root;
    static struct client_quotas quotas;
    const struct identity anna = {.name = "cert:CN=anna", .owner = {1}};
    const struct identity other = {.name = "cert:CN=anna", .owner = {1, 2}};
    account_init(&root, NULL, 1000);
    client_quotas_init(&quotas, &root, 600);
    struct client_quota *a = client_quota_get(&quotas, &anna);
    struct client_quota *b = client_quota_get(&quotas, &anna);
    assert_ptr_equal(a, b);
    struct client_quota *c = client_quota_get(&quotas, &other);
    assert_ptr_not_equal(a, c);
    assert_string_equal(c->name, "cert:CN=anna");
    account_charge(&a->account, ACCOUNT_INPUT, 400);
    account_charge(&c->account, ACCOUNT_PATIENT, 500);
    assert_int_equal(account_room(&a->account), 200);
    assert_int_equal(account_used(&root), 900);
    account_refund(&a->account, ACCOUNT_INPUT, 400);
    account_refund(&c->account, ACCOUNT_PATIENT, 500);
    client_quota_put(c);
    client_quota_put(b);
    assert_ptr_equal(client_quota_get(&quotas, &anna), a);
    client_quota_put(a);
    client_quota_put(a); /* the last reference: a leak checker tells whether the quota was freed */
}

/* Owners are visited in descending order of size, each once, and owners below the least size are
 * not visited. */
static void test_shares(void **state)
{
    (void)state;
    enum { N = 40 };
    struct account root;
    struct store_shares shares;
    struct store_share *share[N];
    uint32_t seed = 7;
    account_init(&root, NULL, ACCOUNT_NO_LIMIT);
    store_shares_init(&shares, &root);
    for (int i = 0; i < N; i++) {
        uint8_t id[OWNER_BYTES] = {(uint8_t)i, 1};
        assert_null(store_share_find(&shares, id));
        share[i] = store_share_get(&shares, id);
        account_charge(&share[i]->account, ACCOUNT_ASSETS, next_random(&seed) % 1000);
        share[i]->n_entries = next_random(&seed) % 50;
        assert_ptr_equal(store_share_find(&shares, id), share[i]);
        store_share_put(&shares, share[i]);
    }
    assert_int_equal(shares.n, N);
    for (int kind = SHARE_BYTES; kind <= SHARE_ENTRIES; kind++) {
        const uint64_t least = kind == SHARE_BYTES ? 300 : 15;
        unsigned n = 0, n_larger = 0;
        uint64_t before = UINT64_MAX;
        store_shares_begin(&shares);
        for (struct store_share *s; (s = store_shares_next(&shares, kind, least)); n++) {
            assert_true(store_share_held(s, kind) <= before);
            before = store_share_held(s, kind);
        }
        for (int i = 0; i < N; i++)
            n_larger += store_share_held(share[i], kind) > least;
        assert_int_equal(n, n_larger);
        assert_true(n > N / 4 && n < N);
    }
    for (int i = 0; i < N; i++)
        store_share_put(&shares, share[i]);
    assert_int_equal(shares.n, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sums),
        cmocka_unit_test(test_quotas),
        cmocka_unit_test(test_shares),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
