/* mock.c -- see mock.h. */
#include "config.h"

#include "mock.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

struct mock mock;

static sph_status work(const sph_batch *b)
{
    (void)b;
    return SPH_OK;
}

static const void *descriptor_of(enum kind kind)
{
    const void *const all[KIND_COUNT] = {
        [KIND_FUNCTION] = &mock.function, [KIND_EOS] = &mock.eos,
        [KIND_BOUNDARY] = &mock.boundary, [KIND_KERNEL] = &mock.kernel,
        [KIND_SCHEME] = &mock.scheme,     [KIND_EXACT] = &mock.exact};

    return all[kind];
}

static sph_status init(const sph_host *host)
{
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        const char *id = mock.kind_id ? mock.kind_id : kind_id[kind];
        if (mock.kind != KIND_COUNT && (int)mock.kind != kind)
            continue;
        for (int i = 0; i <= mock.twice; i++) {
            const sph_status status = host->register_item(host, id, descriptor_of((enum kind)kind));
            if (status != SPH_OK)
                return status;
        }
    }
    return SPH_OK;
}

static void fini(const sph_host *host)
{
    (void)host;
    mock.finished++;
}

const sph_plugin *mock_entry(void)
{
    return &mock.plugin;
}

static void reset_items(void)
{
    mock.prop[0] = (sph_prop){"rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_READ, 0};
    mock.prop[1] = (sph_prop){"p", NULL, NULL, SPH_SCALAR, SPH_DST_WRITE, 0};
    mock.prop[2] = (sph_prop){"again", "", "", SPH_INT32, SPH_DST_WRITE, 0};
    mock.inverse_prop[0] = (sph_prop){"rho", "", "", SPH_SCALAR, SPH_DST_WRITE, 0};
    mock.inverse_prop[1] = (sph_prop){"p", "", "", SPH_SCALAR, SPH_DST_READ, 0};
    mock.param[0] = (sph_param)SPH_PARAM("gamma", "", "", 1.4, 1, 10);
    mock.param[1] = (sph_param){"solver", "", "", 1, 0, 0, "exact|hllc", 0, 0};
    mock.param[2] = (sph_param)SPH_PARAM("x0", "m", "must be given", NAN, 1, 0);
    mock.item = (sph_item){sizeof(sph_item),    SPH_ALL_DIMS,      "thing", "a thing", NULL,
                           LIST_OF(mock.param), LIST_OF(mock.prop)};
    mock.plain_item = mock.item;
    mock.plain_item.params = mock.plain_item.props = (sph_list)SPH_NO_LIST;
    mock.life = (sph_life){sizeof(sph_life), 0, NULL, NULL};
}

static sph_list one_value(int k, const char *name, uint32_t index, uint32_t type)
{
    mock.value[k] = (sph_device_value){name, index, type};
    return (sph_list){&mock.value[k], 1, sizeof(mock.value[k])};
}

static sph_list one_at(int k, const char *name, uint32_t index, uint32_t type)
{
    mock.at[k] = (sph_device_value){name, index, type};
    return (sph_list){&mock.at[k], 1, sizeof(mock.at[k])};
}

/* rho, read, is index 0; p, written, 1; again, an int32 that is written, 2: to be read as well it needs
 * another access. */
static void reset_point(void)
{
    mock.fail[0] = "thing: no";
    mock.point = (sph_device_point){.size = sizeof(sph_device_point),
                                    .text = "p = gamma * rho;",
                                    .file = "finish.body.h",
                                    .in = one_at(0, "rho", 0, SPH_SCALAR),
                                    .out = one_at(1, "p", 1, SPH_SCALAR),
                                    .inout = one_at(2, "again", 2, SPH_INT32),
                                    .param = one_at(3, "gamma", 0, 0),
                                    .state = one_at(4, "own", 3, 0),
                                    .fail = LIST_OF(mock.fail)};
}

/* A pair function of its own: rho, read on both sides, is index 0; p, written, index 1. */
static void reset_device(void)
{
    mock.device = (sph_device_body){.size = sizeof(sph_device_body),
                                    .reach = SPH_GATHER,
                                    .text = "sph_add(sum, rho_i);",
                                    .file = "thing.body.h",
                                    .i = one_value(0, "rho", 0, SPH_SCALAR),
                                    .j = one_value(1, "rho", 0, SPH_SCALAR),
                                    .sum = one_value(2, "sum", 1, SPH_SCALAR),
                                    .min = one_value(3, "least", 1, SPH_SCALAR),
                                    .max = one_value(4, "most", 1, SPH_SCALAR),
                                    .param = one_value(5, "gamma", 0, 0)};
}

void mock_reset(enum kind kind)
{
    memset(&mock, 0, sizeof(mock));
    mock.kind = kind;
    reset_items();
    reset_device();
    reset_point();
    mock.rate[0] = (sph_rate){"u", "p", SPH_KICK, 0};
    mock.reduction[0] = (sph_reduction){"least", "rho", SPH_REDUCE_MIN, SPH_USE_TIME_STEP};
    mock.step[0] = (sph_step)SPH_STEP(SPH_AT_EVALUATE, "thing");
    mock.step[1] = (sph_step){SPH_AT_EVALUATE, SPH_KIND_EOS, NULL, NULL, NULL, 0, 0};
    mock.term[0] = (sph_kernel_term){1, 2, 3, 0};
    mock.term[1] = (sph_kernel_term){-4, 1, 3, 0};
    mock.function = (sph_function){.size = sizeof(sph_function),
                                   .shape = SPH_PAIR,
                                   .item = &mock.item,
                                   .life = &mock.life,
                                   .run = work,
                                   .reach = SPH_GATHER,
                                   .max_sweeps = 10,
                                   .unfinished = "again",
                                   .rates = LIST_OF(mock.rate),
                                   .reductions = LIST_OF(mock.reduction)};
    mock.eos = (sph_eos){.size = sizeof(sph_eos),
                         .item = &mock.item,
                         .life = &mock.life,
                         .run = work,
                         .inverse = work,
                         .inverse_props = LIST_OF(mock.inverse_prop)};
    mock.boundary = (sph_boundary){sizeof(sph_boundary), 0, &mock.plain_item, LIST_OF(mock.step)};
    mock.kernel = (sph_kernel){
        .size = sizeof(sph_kernel),
        .item = &mock.plain_item,
        .support = 2,
        .norm = {0, 1. / 6, 5 / (14 * M_PI), 1 / (4 * M_PI)},
        .terms = {SPH_NO_LIST, LIST_OF(mock.term), LIST_OF(mock.term), LIST_OF(mock.term)}};
    mock.scheme = (sph_scheme){.size = sizeof(sph_scheme),
                               .item = &mock.plain_item,
                               .kernel = "thing",
                               .integrator = "kdk",
                               .cfl = .3,
                               .steps = LIST_OF(mock.step)};
    mock.exact = (sph_exact){sizeof(sph_exact), 0, &mock.item, NULL, work};
    mock.plugin = (sph_plugin){sizeof(sph_plugin),
                               SPH_PLUGIN_MAGIC,
                               SPH_ABI_MAJOR,
                               SPH_ABI_MINOR,
                               "mock",
                               "1.0",
                               "none",
                               "a mock",
                               init,
                               fini};
}

const char *mock_refusal(void)
{
    static struct error e;
    struct registry r;
    int status;

    e = (struct error){0};
    assert_int_equal(registry_init(&r, &e), 0);
    status = registry_add(&r, MOCK_FILE, mock_entry, NULL, NULL, &e);
    if (status) {
        assert_int_equal(e.exit_code, EXIT_REFUSED);
        assert_int_equal(r.n_plugin, 0);
        assert_int_equal(r.n_entry, 0);
    }
    registry_fini(&r);
    return status ? e.text : NULL;
}
