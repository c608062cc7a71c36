/* plugins.c -- see plugins.h. */
#include "config.h"

#include "plugins.h"

#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

void plugins_load(struct registry *r, const char *name)
{
    struct error e = {0};

    assert_int_equal(registry_init(r, &e), 0);
    if (loader_load(r, name, &e))
        fail_msg("%s", e.text);
}

const struct entry *plugins_find(const struct registry *r, enum kind kind, const char *name)
{
    const struct entry *x = registry_find(r, kind, name);

    assert_non_null(x);
    return x;
}

/* The word of a choice, of n bytes at *word, by its index. */
static size_t word_of(const char *choices, int index, const char **word)
{
    *word = choices;
    for (; index > 0 && strchr(*word, '|'); index--)
        *word = strchr(*word, '|') + 1;
    return strcspn(*word, "|");
}

void plugins_set(struct sph_config *c, const sph_item *item, const char *const *names,
                 const double *values)
{
    struct error e = {0};

    for (int i = 0; names && names[i]; i++) {
        const sph_param *p = item->params.data;
        char text[64];
        const char *word = NULL;
        while (strcmp(p->name, names[i]) != 0) {
            p++;
            assert_true(p - (const sph_param *)item->params.data < item->params.count);
        }
        if (p->choices) {
            const size_t n = word_of(p->choices, (int)values[i], &word);
            snprintf(text, sizeof(text), "%.*s", (int)n, word);
        }
        if (config_set(c, names[i], values[i], word ? text : NULL, &e))
            fail_msg("%s", e.text);
    }
}

void trial_init(struct trial *u, struct registry *r, const sph_item *item, const sph_life *life,
                const sph_list *props, int dim, const char *const *names, const double *values)
{
    struct error e = {0};

    memset(u, 0, sizeof(*u));
    u->registry = r;
    u->item = item;
    u->life = life;
    assert_int_equal(config_init(&u->config, item, &e), 0);
    plugins_set(&u->config, item, names, values);
    assert_int_equal(config_check(&u->config, &e), 0);
    if (life && life->create)
        assert_int_equal(life->create(&r->host, &u->config, (uint32_t)dim, &u->state), SPH_OK);
    assert_true(props->count <= PLUGINS_COLUMNS);
    u->batch = (sph_batch){.size = (uint32_t)sizeof(u->batch),
                           .dim = (uint32_t)dim,
                           .real = SPH_F64,
                           .lanes = SPH_LANES,
                           .dst = u->column,
                           .src = u->column,
                           .n_columns = props->count,
                           .n_params = item->params.count,
                           .param = u->config.value,
                           .state = u->state,
                           .host = &r->host};
}

void trial_fini(struct trial *u)
{
    if (u->life && u->life->destroy)
        u->life->destroy(&u->registry->host, u->state);
    config_fini(&u->config);
}

void use_column(struct trial *u, uint32_t k, double *data, uint64_t n)
{
    u->column[k] = (sph_column){.data = data, .plane = n};
}

sph_status use_run(struct trial *u, sph_range_fn run, double time, uint64_t n)
{
    u->batch.first = 0;
    u->batch.count = n;
    u->batch.n_dst = n;
    u->batch.time = time;
    return run(&u->batch);
}

FILE *plugins_open_table(const char *file)
{
    const char *source = getenv("top_srcdir");
    char path[4096];
    FILE *f;

    snprintf(path, sizeof(path), "%s/tests/reference/%s", source ? source : ".", file);
    f = fopen(path, "r");
    if (!f)
        fail_msg("%s: %s", path, strerror(errno));
    return f;
}

double *plugins_table(const char *file, int *columns, int *rows)
{
    FILE *f = plugins_open_table(file);
    double *value = NULL;
    int n = 0;
    char line[4096];

    *columns = 0;
    *rows = 0;
    for (int i = 0; fgets(line, sizeof(line), f); i++) {
        char *s = line;
        int here = 0;
        if (i < 2) /* where it is from; names of the columns */
            continue;
        for (char *end = s; *s && *s != '\n'; s = end + (*end == ','), here++) {
            const double x = strtod(s, &end);
            const bool number = end > s && strchr(",\n", *end);
            end += strcspn(end, ",\n");
            value = realloc(value, (size_t)(n + 1) * sizeof(*value));
            assert_non_null(value);
            value[n++] = number ? x : NAN;
        }
        assert_true(*columns == 0 || here == *columns);
        *columns = here;
        (*rows)++;
    }
    fclose(f);
    assert_true(*rows > 0);
    return value;
}
