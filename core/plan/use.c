/* plan/use.c -- one configured use of an item: parameters from JSON, the plugin's own state. */
#include "plan/plan.h"
#include "base/text.h"
#include <math.h>
#include <string.h>

int use_init(struct use *u, const struct entry *entry, const sph_item *item, const sph_life *life,
             struct error *e)
{
    *u = (struct use){.entry = entry, .item = item, .life = life};
    return config_init(&u->config, item, e);
}

bool use_declares(const struct use *u, const char *name)
{
    for (uint32_t i = 0; i < u->item->params.count; i++) {
        const sph_param *p = list_at(&u->item->params, i);
        if (strcmp(p->name, name) == 0)
            return true;
    }
    return false;
}

int use_set(struct use *u, const struct document *d, const cJSON *member, struct error *e)
{
    struct error inner = {0};
    int status;
    for (uint32_t i = 0; i < u->item->params.count; i++) {
        const sph_param *p = list_at(&u->item->params, i);
        if (p->type == SPH_PARAM_TABLE && strcmp(p->name, member->string) == 0)
            return use_set_table(u, d, member, e);
    }
    if (cJSON_IsNumber(member))
        status = config_set(&u->config, member->string, member->valuedouble, NULL, &inner);
    else if (cJSON_IsString(member))
        status = config_set(&u->config, member->string, NAN, member->valuestring, &inner);
    else if (cJSON_IsBool(member))
        status =
            config_set(&u->config, member->string, cJSON_IsTrue(member) ? 1.0 : 0.0, NULL, &inner);
    else
        return document_fail(d, member, e, "a parameter is a number or a word");
    if (status)
        return document_fail(d, member, e, "%s", inner.text);
    return 0;
}

int use_set_all(struct use *u, const struct document *d, const cJSON *members, struct error *e)
{
    const cJSON *member;
    cJSON_ArrayForEach(member, members)
    {
        if (use_declares(u, member->string)) {
            if (use_set(u, d, member, e))
                return -1;
            continue;
        }
        const char *name[64];
        char near[512];
        size_t n = 0;
        for (uint32_t k = 0; k < u->item->params.count && n < 64; k++)
            name[n++] = ((const sph_param *)list_at(&u->item->params, k))->name;
        return document_fail(d, member, e, "%s has no parameter \"%s\"%s", u->item->name,
                             member->string,
                             text_suggest(near, sizeof near, member->string, name, n));
    }
    return 0;
}

int use_create(struct use *u, struct registry *r, int dim, struct error *e)
{
    if (config_check(&u->config, e))
        return -1;
    if (!u->life || !u->life->create)
        return 0;
    sph_status status = u->life->create(&r->host, &u->config, (uint32_t)dim, &u->state);
    if (status == SPH_OK)
        return 0;
    char why[512];
    registry_reason(r, status, why, sizeof why);
    return error_set(e, EXIT_USAGE, "%s: %s", u->item->name, why);
}

void use_fini(struct use *u, struct registry *r)
{
    if (u->state && u->life && u->life->destroy)
        u->life->destroy(&r->host, u->state);
    config_fini(&u->config);
    use_tables_free(u->tables);
    *u = (struct use){0};
}

sph_batch use_batch(const struct plan *plan, const struct use *u, const sph_column *dst,
                    uint32_t n_columns, uint64_t n)
{
    return (sph_batch){.size = sizeof(sph_batch),
                       .dim = (uint32_t)plan->dim,
                       .real = SPH_F64,
                       .lanes = SPH_LANES,
                       .count = n,
                       .n_dst = n,
                       .dst = dst,
                       .n_columns = n_columns,
                       .n_params = u->item->params.count,
                       .param = u->config.value,
                       .state = u->state,
                       .kernel = plan->has_kernel ? &plan->kernel : NULL,
                       .host = &plan->registry->host};
}
