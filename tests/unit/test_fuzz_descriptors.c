/* test_fuzz_descriptors.c -- descriptors of every kind with one to three members changed at
 * random: sizes, counts, strides, numbers, strings, pointers. Each is taken, or refused with one
 * sentence that names the file; none ends the program, nothing is left behind, and the registry
 * then takes a faultless plugin. Every struct, list and string lies in a block of its own of
 * just its size, so that a sanitizer sees every byte read too many.
 *
 * The numbers are the same each time; SPH_FUZZ_SEED and SPH_FUZZ_N choose others and more. */
#include "config.h"

#include "mock.h"
#include "shapes.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cmocka.h>

/* -- Numbers -------- */

static uint64_t seed;

static uint64_t draw(void)
{
    uint64_t z = seed += 0x9e3779b97f4a7c15u;

    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

static size_t below(size_t n)
{
    return (size_t)(draw() % n);
}

/* -- Memory: blocks that are freed together -------- */

static void *block[512];
static size_t n_block;

static void *keep(void *p)
{
    assert_non_null(p);
    assert_true(n_block < sizeof(block) / sizeof(block[0]));
    return block[n_block++] = p;
}

static void *copy_of(const void *in, size_t n)
{
    return memcpy(keep(malloc(n ? n : 1)), in, n);
}

static void free_all(void)
{
    while (n_block > 0)
        free(block[--n_block]);
}

/* -- The tree of one descriptor -------- */

struct place {
    const struct member *member;
    char *base;
    char **owner;  /* the pointer to base */
    size_t size;   /* of base's block */
    sph_list list; /* as it was; and of a link: the struct as a list of one */
};
static struct place place[400];
static size_t n_place;

static char *get_pointer(const char *at)
{
    char *p;

    memcpy(&p, at, sizeof(p));
    return p;
}

/* Moves a string into a block of its own. */
static void own_text(char *at)
{
    const char *s = get_pointer(at);

    if (s)
        s = copy_of(s, strlen(s) + 1);
    memcpy(at, &s, sizeof(s));
}

static void own(char *base, char **owner, const struct shape *shape)
{
    for (const struct member *m = shape->member; m->type != END; m++) {
        char *at = base + m->at;
        assert_true(n_place < sizeof(place) / sizeof(place[0]));
        place[n_place] = (struct place){m, base, owner, shape->size, {NULL, 0, 0}};
        struct place *p = &place[n_place++];
        if (m->type == TEXT)
            own_text(at);
        if (m->type == LINK && get_pointer(at)) {
            char *copy = copy_of(get_pointer(at), m->to->size);
            memcpy(at, &copy, sizeof(copy));
            p->list = (sph_list){copy, 1, (uint32_t)m->to->size};
            own(copy, (char **)(void *)at, m->to);
        }
        if (m->type == LIST) {
            sph_list *list = (sph_list *)(void *)at;
            char *copy = list->count ? copy_of(list->data, list->count * m->to->size) : NULL;
            list->data = copy;
            p->list = *list;
            for (uint32_t i = 0; i < list->count; i++)
                own(copy + i * m->to->size, (char **)(void *)&list->data, m->to);
        }
    }
}

/* -- Changing one member -------- */

static char *wall; /* the last byte of a page, behind which nothing may be touched */

/* Somewhere; but not where the address sanitizer keeps its books, which are there for all but
 * it. */
static const void *wild(void)
{
    const uint64_t p = draw() >> below(64);

    return (const void *)(uintptr_t)(p > 0x7fff0000u && p < 0x200000000000u ? p | 1ull << 62 : p);
}

static const char *some_text(void)
{
    static const char *const texts[] = {"",
                                        "a",
                                        "thing",
                                        "rho",
                                        "p",
                                        "again",
                                        "x0",
                                        "Thing",
                                        "a b",
                                        "two\nline",
                                        "tab\t",
                                        "\x01",
                                        "\xff\xfe",
                                        "\xc3",
                                        "\xc3\xbc",
                                        "|",
                                        "a|b",
                                        "a||b",
                                        "%s%n%s",
                                        "1",
                                        "-",
                                        "evaluate",
                                        "sph.function/0",
                                        "\x7f",
                                        "\xed\xa0\x80",
                                        "\xf4\x90\x80\x80"};
    static const size_t lengths[] = {62, 63, 64, 65, 1000, 1023, 1024, 4095, 4096, 4097, 9000};
    const size_t choice = below(8);
    char *s;

    if (choice == 0)
        return NULL;
    if (choice == 1) { /* not ended before memory is */
        const size_t n = 1 + below(100);
        memset(wall - n + 1, 'a', n);
        return wall - n + 1;
    }
    if (choice == 2)
        return wild();
    if (choice == 3) {
        const size_t n = lengths[below(sizeof(lengths) / sizeof(lengths[0]))];
        s = keep(malloc(n + 1));
        memset(s, 'a', n);
        s[n] = '\0';
        return s;
    }
    s = (char *)texts[below(sizeof(texts) / sizeof(texts[0]))];
    return copy_of(s, strlen(s) + 1);
}

static uint32_t some_word(uint32_t now)
{
    static const uint32_t words[] = {
        0,   1,   2,    3,    4,    5,    6,     7,     8,     16,       32,         64,        127,
        128, 255, 1023, 1024, 1025, 4096, 65535, 65536, 65537, 1u << 31, 0x7fffffff, 0xffffffff};

    switch (below(3)) {
    case 0:
        return now ^ 1u << below(32);
    case 1:
        return (uint32_t)draw();
    default:
        return words[below(sizeof(words) / sizeof(words[0]))];
    }
}

static double some_real(void)
{
    static const double reals[] = {0,        -0.0,     1,         -1,      0.5,      2,
                                   NAN,      INFINITY, -INFINITY, DBL_MAX, -DBL_MAX, DBL_MIN,
                                   4.9e-324, 1e-300,   1e300,     1e10,    16,       17};
    const uint64_t bits = draw();
    double x;

    if (below(3))
        return reals[below(sizeof(reals) / sizeof(reals[0]))];
    memcpy(&x, &bits, sizeof(x));
    return x;
}

static const void *some_pointer(const sph_list *was)
{
    const size_t n = (size_t)was->count * was->stride;
    char *moved;

    switch (below(4)) {
    case 0:
        return NULL;
    case 1:
        return wall - below(n == 0 ? 1 : n < 4096 ? n : 4096); /* not all of it is there */
    case 2:
        return wild();
    default: /* not aligned, but all there */
        if (n == 0)
            return NULL;
        moved = keep(malloc(n + 1));
        return memcpy(moved + 1, was->data, n);
    }
}

/* Another count or stride; what could be read by it is there. */
static void change_list(sph_list *list, const sph_list *was)
{
    size_t bytes;
    char *data;

    switch (below(3)) {
    case 0:
        if (list->count == was->count && list->stride == was->stride)
            list->data = some_pointer(was);
        else
            list->data = wild(); /* a copy of what there was would be too short */
        return;
    case 1:
        list->count = below(2) ? (uint32_t)below(9) : some_word(list->count);
        break;
    default:
        list->stride = below(2) ? (uint32_t)(was->stride + 8 * below(4)) : some_word(list->stride);
        break;
    }
    bytes = (size_t)list->count * list->stride;
    if (bytes > 1u << 20)
        list->data = wild();
    if (bytes == 0 || bytes > 1u << 20)
        return; /* absurd, or more than there is, which is for reach.c to find out */
    data = keep(malloc(bytes));
    for (size_t i = 0; i < bytes; i++)
        data[i] = (char)draw();
    for (uint32_t i = 0; was->count && i < list->count; i++) {
        const size_t part = was->stride < list->stride ? was->stride : list->stride;
        memcpy(data + (size_t)i * list->stride,
               (const char *)was->data + (size_t)(i % was->count) * was->stride, part);
    }
    list->data = data;
}

/* A struct that says another size; if it is smaller, there is no more than that. */
static void change_size(const struct place *p)
{
    const uint32_t size = some_word((uint32_t)p->size);
    const size_t least = p->member == shape_plugin.member ? 16 : 4;

    memcpy(p->base, &size, sizeof(size));
    if (size < p->size) {
        char *less = copy_of(p->base, size < least ? least : size);
        memcpy((void *)p->owner, &less, sizeof(less));
    }
}

static void change(const struct place *p)
{
    char *at = p->base + p->member->at;
    const void *pointer = NULL;
    uint32_t word;
    double real;

    switch (p->member->type) {
    case SIZE:
        change_size(p);
        return;
    case WORD:
        memcpy(&word, at, sizeof(word));
        word = some_word(word);
        memcpy(at, &word, sizeof(word));
        return;
    case REAL:
        real = some_real();
        memcpy(at, &real, sizeof(real));
        return;
    case TEXT:
        pointer = some_text();
        break;
    case LINK:
        pointer = some_pointer(&p->list);
        break;
    case LIST:
        change_list((sph_list *)(void *)at, &p->list);
        return;
    case CODE: /* NULL: where else code is cannot be asked */
    case END:
        break;
    }
    memcpy(at, &pointer, sizeof(pointer));
}

/* -- The plugin -------- */

static struct {
    const char *kind; /* of what init registers */
    char *descriptor, *plugin, *population, *state;
} under_test;

static sph_status save(const sph_host *host, const void *in, const sph_writer *out)
{
    (void)host;
    (void)in;
    (void)out;
    return SPH_OK;
}

static sph_status restore(const sph_host *host, void *out, uint32_t format, const void *bytes,
                          uint64_t n)
{
    (void)host;
    (void)out;
    (void)format;
    (void)bytes;
    (void)n;
    return SPH_OK;
}

static sph_status create(const sph_host *host, const sph_config *config, uint32_t dim, void **out)
{
    (void)host;
    (void)config;
    (void)dim;
    *out = NULL;
    return SPH_OK;
}

static sph_status init(const sph_host *host)
{
    const sph_population_ext *populations = host->extension(host, SPH_EXT_POPULATION);
    const sph_state_ext *states = host->extension(host, SPH_EXT_STATE);
    sph_status status = host->register_item(host, under_test.kind, under_test.descriptor);

    if (status == SPH_OK && under_test.population && populations)
        status = populations->declare(host, "thing", (void *)under_test.population);
    if (status == SPH_OK && under_test.state && states)
        status = states->declare(host, under_test.kind, "thing", (void *)under_test.state);
    return below(4) ? status : SPH_OK; /* some do not care */
}

static const sph_plugin *entry(void)
{
    return (const sph_plugin *)(void *)under_test.plugin;
}

static const sph_plugin *good_entry(void)
{
    return &mock.plugin;
}

/* -- The test -------- */

struct root {
    const char *name;
    enum kind kind;
    bool with_plugin, with_population, with_state;
};

static char *own_root(char **owner, const void *in, const struct shape *shape, bool changed)
{
    const size_t before = n_place;

    *owner = copy_of(in, shape->size);
    own(*owner, owner, shape);
    if (!changed)
        n_place = before;
    return *owner;
}

/* A pair function with all that one can have, an equation of state with a body for devices. */
static void furnish(void)
{
    static sph_prop props[4];
    static sph_device_value i_values[1], j_values[1], sums[1], params[1];
    static sph_device_body body;

    props[0] = mock.prop[0];
    props[0].access |= SPH_SRC_READ;
    props[1] = mock.prop[1];
    props[2] = mock.prop[2];
    props[3] = (sph_prop){.name = "sum", .type = SPH_SCALAR, .access = SPH_DST_SUM};
    i_values[0] = j_values[0] = (sph_device_value){"rho", 0, SPH_SCALAR};
    sums[0] = (sph_device_value){"sum", 3, SPH_SCALAR};
    params[0] = (sph_device_value){"gamma", 0, 0};
    body = (sph_device_body){.size = sizeof(body),
                             .reach = SPH_GATHER,
                             .text = "sum += rho_j;\n",
                             .file = "thing.body.h",
                             .i = LIST_OF(i_values),
                             .j = LIST_OF(j_values),
                             .sum = LIST_OF(sums),
                             .param = LIST_OF(params)};
    mock.item.props = LIST_OF(props);
    mock.function.device = &body;
    mock.life.create = create;
    mock.prop[2].access = props[2].access = SPH_DST_UPDATE;
    mock.function.before = mock.function.after = mock.function.run;
    mock.function.device_before = mock.function.device_after = mock.eos.device = &mock.point;
}

static void prepare(const struct root *root)
{
    static const struct shape *const shapes[KIND_COUNT] = {
        [KIND_FUNCTION] = &shape_function, [KIND_EOS] = &shape_eos,
        [KIND_BOUNDARY] = &shape_boundary, [KIND_KERNEL] = &shape_kernel,
        [KIND_SCHEME] = &shape_scheme,     [KIND_EXACT] = &shape_exact};
    const void *const descriptors[KIND_COUNT] = {
        [KIND_FUNCTION] = &mock.function, [KIND_EOS] = &mock.eos,
        [KIND_BOUNDARY] = &mock.boundary, [KIND_KERNEL] = &mock.kernel,
        [KIND_SCHEME] = &mock.scheme,     [KIND_EXACT] = &mock.exact};
    const sph_population births = {.size = sizeof(births),
                                   .create = "again",
                                   .remove = "again",
                                   .born_props = LIST_OF(mock.prop)};
    const sph_state kept = {.size = sizeof(kept), .save = save, .restore = restore};
    const bool others = root->with_plugin || root->with_population || root->with_state;

    mock_reset(root->kind);
    mock.life.create = create;
    mock.plugin.init = init;
    if (root->kind == KIND_FUNCTION)
        furnish();
    n_place = 0;
    memset(&under_test, 0, sizeof(under_test));
    under_test.kind = kind_id[root->kind];
    own_root(&under_test.descriptor, descriptors[root->kind], shapes[root->kind], !others);
    own_root(&under_test.plugin, &mock.plugin, &shape_plugin, root->with_plugin);
    if (root->with_population)
        own_root(&under_test.population, &births, &shape_population, true);
    if (root->with_state)
        own_root(&under_test.state, &kept, &shape_state, true);
}

/* What is to be spoiled is faultless before. */
static void faultless(const struct root *root)
{
    struct registry r;
    struct error e = {0};

    prepare(root);
    assert_int_equal(registry_init(&r, &e), 0);
    if (registry_add(&r, MOCK_FILE, entry, NULL, NULL, &e))
        fail_msg("%s", e.text);
    registry_fini(&r);
    free_all();
}

static void is_one_sentence(const struct error *e)
{
    assert_int_equal(e->exit_code, EXIT_REFUSED);
    if (strncmp(e->text, "plugin " MOCK_FILE ": ", strlen("plugin " MOCK_FILE ": ")) != 0)
        fail_msg("does not name the file: %s", e->text);
    for (const char *s = e->text; *s; s++)
        if ((unsigned char)*s < 0x20 || *s == 0x7f)
            fail_msg("is not one line: %s", e->text);
}

/* What is registered can be used: parameters at their defaults. */
static void use(const struct registry *r)
{
    for (size_t i = 0; i < r->n_entry; i++) {
        struct error e = {0};
        struct sph_config c;
        if (config_init(&c, r->entry[i].item, &e) == 0)
            config_fini(&c);
    }
}

/* 1 if it was taken. */
static unsigned once(const struct root *root)
{
    struct registry r;
    struct error e = {0};
    int status;

    prepare(root);
    for (size_t n = 1 + below(3); n > 0; n--)
        change(&place[below(n_place)]);
    assert_int_equal(registry_init(&r, &e), 0);
    status = registry_add(&r, MOCK_FILE, entry, NULL, NULL, &e);
    if (status) {
        is_one_sentence(&e);
        assert_int_equal(r.n_plugin, 0);
        assert_int_equal(r.n_entry, 0);
        /* Nothing of it stands in the way of another. */
        mock_reset(KIND_COUNT);
        assert_int_equal(registry_add(&r, MOCK_FILE, good_entry, NULL, NULL, &e), 0);
        assert_int_equal(r.n_entry, KIND_COUNT);
    }
    use(&r);
    registry_fini(&r);
    free_all();
    return status == 0;
}

static void fuzz(const struct root *root)
{
    const char *wish = getenv("SPH_FUZZ_N");
    const unsigned n = wish ? (unsigned)strtoul(wish, NULL, 10) : 10000;
    const uint64_t begin = seed;
    unsigned taken = 0;

    faultless(root);
    for (unsigned i = 0; i < n; i++)
        taken += once(root);
    printf("%-10s %u changed at random from seed %llu: %u refused, %u taken\n", root->name, n,
           (unsigned long long)begin, n - taken, taken);
    if (!wish)
        assert_true(taken > n / 50 && taken < n / 2);
}

static int setup(void **unused)
{
    const char *wish = getenv("SPH_FUZZ_SEED");
    const size_t page = (size_t)sysconf(_SC_PAGESIZE);
    char *pages = mmap(NULL, 3 * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);

    (void)unused;
    seed = wish ? strtoull(wish, NULL, 10) : 1;
    if (pages == MAP_FAILED || mprotect(pages + 2 * page, page, PROT_NONE))
        return -1;
    wall = pages + 2 * page - 1;
    return 0;
}

#define ROOT(label, ...)                                                                           \
    static void of_##label(void **unused)                                                          \
    {                                                                                              \
        const struct root root = {#label, __VA_ARGS__};                                            \
        (void)unused;                                                                              \
        fuzz(&root);                                                                               \
    }
ROOT(function, KIND_FUNCTION, false, false, false)
ROOT(eos, KIND_EOS, false, false, false)
ROOT(boundary, KIND_BOUNDARY, false, false, false)
ROOT(kernel, KIND_KERNEL, false, false, false)
ROOT(scheme, KIND_SCHEME, false, false, false)
ROOT(exact, KIND_EXACT, false, false, false)
ROOT(plugin, KIND_EXACT, true, false, false)
ROOT(population, KIND_FUNCTION, false, true, false)
ROOT(state, KIND_FUNCTION, false, false, true)

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(of_function), cmocka_unit_test(of_eos),
        cmocka_unit_test(of_boundary), cmocka_unit_test(of_kernel),
        cmocka_unit_test(of_scheme),   cmocka_unit_test(of_exact),
        cmocka_unit_test(of_plugin),   cmocka_unit_test(of_population),
        cmocka_unit_test(of_state),
    };

    return cmocka_run_group_tests(tests, setup, NULL);
}
