/* test_opencl_advance.c -- integrators on a device, against their definition and against whole
 * steps of the host. Skips itself where there is no device. */
#include "config.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "device_columns.h"
#include "integrators/families.h"
#include "moving.h"

/* The table's operations but for evaluations on columns of their own, by their definition. */
static void by_hand(struct particles *p, const struct rate *rate, const struct op *op, double dt)
{
    const struct column *c = p->column;
    if (!(op->on & rate->kind))
        return;
    for (uint32_t k = 0; k < c[rate->property].ncomp; k++)
        for (size_t i = 0; i < p->n; i++) {
            const double r = column_get(&c[rate->rate], k, i);
            const double y = column_get(&c[rate->property], k, i);
            double value = 0;
            switch (op->kind) {
            case OP_COMBINE:
                for (int s = 0; s < SLOT_COUNT; s++)
                    if (op->weight[s] != 0.0)
                        value += op->weight[s] * column_get(&c[rate->kept[s]], k, i);
                value += op->a * dt * r;
                if (op->a2 != 0.0 && rate->rate == V)
                    value += op->a2 * dt * dt * column_get(&c[F], k, i);
                column_set(&c[rate->kept[op->to]], k, i, value);
                break;
            case OP_SWAP:
                column_set(&c[rate->property], k, i, column_get(&c[rate->kept[SLOT_0]], k, i));
                column_set(&c[rate->kept[SLOT_0]], k, i, y);
                break;
            case OP_SAVE_RATES:
                column_set(&c[rate->saved], k, i, r);
                break;
            case OP_CORRECT:
                value = column_get(&c[rate->saved], k, i);
                column_set(&c[rate->property], k, i, y + op->a * dt * (r - value));
                break;
            default:
                break;
            }
        }
}

/* x drifts with v, v is kicked by f (floats), s by g (floats). */
static void rates_of(struct particles *p, struct rate rate[3])
{
    static const struct {
        int property, rate;
        uint32_t kind;
    } each[3] = {{X, V, SPH_DRIFT}, {V, F, SPH_KICK}, {S, G, SPH_KICK}};
    for (int q = 0; q < 3; q++) {
        const struct column *c = &p->column[each[q].property];
        char name[16];
        rate[q] = (struct rate){.property = each[q].property,
                                .rate = each[q].rate,
                                .kind = each[q].kind,
                                .kept = {each[q].property, 0, 0},
                                .closed = NO_PASS,
                                .anew = true};
        for (int s = 0; s < 3; s++) {
            static const char *const end[3] = {"-", ".0", ".1"};
            snprintf(name, sizeof name, "%s%s", p->column[each[q].property].name, end[s]);
            const int k = particles_add(p, name, "", "", c->type, &why);
            c = &p->column[each[q].property];
            assert_true(k >= 0);
            if (s == 0)
                rate[q].saved = k;
            else
                rate[q].kept[s] = k;
        }
    }
    fill(p);
}

static void test_operations(void **state)
{
    size_t count;
    const char *const *name = integrator_names(&count);
    (void)state;
    for (int dim = 1; dim <= 3; dim++)
        for (size_t s = 0; s < COUNT(sizes); s++)
            for (size_t t = 0; t < count; t++) {
                const struct integrator *table = integrator_find(name[t]);
                struct particles p, q;
                struct rate rate[3];
                struct plan_array pa = {.rate = rate, .n_rate = 3};
                struct arena a;
                bool bad;
                if (sizes[s] > 10000 && t % 4)
                    continue;
                make(&p, dim, sizes[s]);
                rates_of(&p, rate);
                make(&q, dim, sizes[s]);
                rates_of(&q, rate);
                open_arena(&a, &p);
                for (size_t c = 0; c < p.n_column; c++)
                    for (uint32_t k = 0; column_is_real(&p.column[c]) && k < p.column[c].ncomp; k++)
                        for (size_t i = 0; i < p.n; i++)
                            column_set(&q.column[c], k, i, column_get(&p.column[c], k, i));
                for (int step = 1; step <= 2; step++) {
                    OK(ops_advance(ops[dim], &a, &pa, table->op, 0, table->n_op, 0.125 * step, &bad,
                                   &why));
                    assert_false(bad);
                    for (size_t o = 0; o < table->n_op; o++)
                        for (int r = 0; r < 3; r++)
                            by_hand(&q, &rate[r], &table->op[o], 0.125 * step);
                }
                for (size_t c = 0; c < p.n_column; c++)
                    if (!a.there[c])
                        OK(arena_get(&a, (int)c, &why));
                memcpy(q.column[I].data, p.column[I].data, p.n * 4);
                memcpy(q.column[L].data, p.column[L].data, p.n * 8);
                for (size_t c = 0; c < p.n_column; c++)
                    for (uint32_t k = 0; column_is_real(&p.column[c]) && k < p.column[c].ncomp; k++)
                        for (size_t i = 0; i < p.n; i++) {
                            const double x = column_get(&p.column[c], k, i);
                            const double y = column_get(&q.column[c], k, i);
                            if (!(fabs(x - y) <= (p.column[c].size == 4 ? 3e-7 : 2e-15)))
                                fail_msg("%s, %s[%u] of %zu: off by %g", name[t], p.column[c].name,
                                         k, i, x - y);
                        }
                for (size_t i = 0; i < p.n && i < 20; i += 3) {
                    const double old = column_get(&p.column[F], 0, p.n - 1 - i);
                    column_set(&p.column[F], 0, p.n - 1 - i, NAN);
                    arena_written_there(&a, F);
                    OK(arena_put(&a, F, &why));
                    OK(ops_advance(ops[dim], &a, &pa, &(struct op)KICK(0.5), 0, 1, 0.1, &bad,
                                   &why));
                    assert_true(bad);
                    column_set(&p.column[F], 0, p.n - 1 - i, old);
                }
                arena_fini(&a);
                particles_fini(&p);
                particles_fini(&q);
            }
}

/* Evaluations on the host, all else of the step on the device: as run_advance. */
static void step_on_device(struct motion *m, struct arena *a, double dt)
{
    struct plan_array *pa = &m->rig.plan.array[0];
    const struct integrator *table = m->rig.plan.integrator;
    struct op op[OPS_MAX];
    const double begin = m->run.time;
    memcpy(op, table->op, table->n_op * sizeof *op);
    if (table->adapt)
        table->adapt(op, m->run.step, m->run.dt_last > 0.0 ? dt / m->run.dt_last : NAN);
    m->run.dt_last = m->run.dt = dt;
    for (size_t k = 0, end; k < table->n_op; k = end + 1) {
        for (end = k; end < table->n_op && op[end].kind != OP_EVALUATE;)
            end++;
        bool bad;
        OK(ops_advance(ops[2], a, pa, op, k, end, dt, &bad, &why));
        assert_false(bad);
        if (end == table->n_op)
            break;
        m->run.time = begin + op[end].a * dt;
        for (size_t c = 0; c < pa->p.n_column; c++)
            if (!a->there[c])
                OK(arena_get(a, (int)c, &why));
        passes(m, MOMENT_EVALUATE);
        put_all(a);
    }
    get_all(a);
    m->run.time = begin + dt;
    m->run.step++;
}

static void test_integrators(void **state)
{
    size_t count;
    const char *const *name = integrator_names(&count);
    (void)state;
    for (size_t t = 0; t < count; t++) {
        struct motion host, here;
        struct motion *both[2] = {&host, &here};
        struct arena a;
        for (int k = 0; k < 2; k++) {
            rig_open(&both[k]->rig, &motion_items,
                     "{'dimensions':2,'domain':{'min':[0,0],'max':[1,1]},'particles':{'mass':{"
                     "'fill':{'lattice':'square','count':9},'fields':{'rho':1,'v':['y','x*y']}}},"
                     "'scheme':{'name':'swing','damping':0.3},'time':{'end':1,'integrator':'%s'},"
                     "'watch':false}",
                     name[t]);
            begin(both[k], 1);
            passes(both[k], MOMENT_EVALUATE);
        }
        struct particles *p = &here.rig.plan.array[0].p, *q = &host.rig.plan.array[0].p;
        open_arena(&a, p);
        for (int n = 0; n < 45; n++) { /* some do something else at the 40th */
            const double dt = n < 42 ? 0.05 : 0.04;
            steps(&host, dt, 1);
            step_on_device(&here, &a, dt);
        }
        for (size_t c = 0; c < p->n_column; c++)
            for (uint32_t k = 0; column_is_real(&p->column[c]) && k < p->column[c].ncomp; k++)
                for (size_t i = 0; i < p->n; i++)
                    if (!strstr(p->column[c].name, ".") &&
                        !(fabs(column_get(&p->column[c], k, i) - column_get(&q->column[c], k, i)) <
                          1e-13))
                        fail_msg("%s: %s is off by %g", name[t], p->column[c].name,
                                 column_get(&p->column[c], k, i) - column_get(&q->column[c], k, i));
        arena_fini(&a);
        end(&host);
        end(&here);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_operations),
        cmocka_unit_test(test_integrators),
    };
    RUN_BOTH(tests);
}
