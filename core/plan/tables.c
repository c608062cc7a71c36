/* plan/tables.c -- the tables that a scene hands to parameters: files, or objects of columns. */
#include "base/text.h"
#include "plan/plan.h"
#include "scene/read.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct use_table {
    struct use_table *next;
    sph_table table; /* as the plugin sees it */
    struct table read;
    const char **name;
    const double **column;
    char *source;
};

void use_tables_free(struct use_table *t)
{
    while (t) {
        struct use_table *next = t->next;
        table_free(&t->read);
        free(t->name);
        free(t->column);
        free(t->source);
        free(t);
        t = next;
    }
}

static int read_file(struct table *t, const struct document *d, const cJSON *member,
                     struct error *e)
{
    struct error inner = {0};
    char *path = document_relative(d, member->valuestring);
    if (!path)
        return error_memory(e, "a path", strlen(member->valuestring));
    int status = table_read(t, path, NULL, &inner);
    free(path);
    return status ? document_fail(d, member, e, "%s", inner.text) : 0;
}

/* {"t": [0, 1], "v": [0, 2]} */
static int read_object(struct table *t, const struct document *d, const cJSON *member,
                       struct error *e)
{
    const cJSON *list, *number;
    t->n = (size_t)cJSON_GetArraySize(member->child);
    cJSON_ArrayForEach(list, member)
    {
        if (!cJSON_IsArray(list))
            return document_fail(d, list, e, "a column of a table is an array of numbers");
        if ((size_t)cJSON_GetArraySize(list) != t->n)
            return document_fail(d, list, e,
                                 "a column of a table is an array of numbers, as long as the "
                                 "others (%zu)",
                                 t->n);
        double *value = table_add(t, list->string);
        if (!value)
            return error_memory(e, "a table", t->n * sizeof *value);
        cJSON_ArrayForEach(number, list)
        {
            if (!cJSON_IsNumber(number))
                return document_fail(d, number, e, "a table holds numbers");
            *value++ = number->valuedouble;
        }
    }
    return 0;
}

static int check_table(const struct table *t, const struct document *d, const cJSON *member,
                       struct error *e)
{
    if (t->n == 0 || t->n_column == 0)
        return document_fail(d, member, e, "the table has no rows");
    for (size_t c = 0; c < t->n_column; c++)
        for (size_t i = 0; i < t->n; i++)
            if (!isfinite(t->column[c].value[i]))
                return document_fail(d, member, e,
                                     "column \"%s\", row %zu of the table is not a finite number",
                                     t->column[c].name, i + 1);
    return 0;
}

int plan_table(struct table *t, const struct document *d, const cJSON *member, struct error *e)
{
    if (!cJSON_IsString(member) && !cJSON_IsObject(member))
        return document_fail(d, member, e,
                             "%s is a table: give the name of a file or an object of columns",
                             member->string);
    if (cJSON_IsString(member) ? read_file(t, d, member, e) : read_object(t, d, member, e))
        return -1;
    return check_table(t, d, member, e);
}

const char *plan_table_source(const cJSON *member)
{
    return cJSON_IsString(member) ? member->valuestring : "scene";
}

static int publish(struct use_table *t, struct error *e)
{
    const size_t n = t->read.n_column;
    t->name = calloc(n, sizeof *t->name);
    t->column = calloc(n, sizeof *t->column);
    if (!t->name || !t->column)
        return error_memory(e, "a table", n * sizeof *t->column);
    for (size_t c = 0; c < n; c++) {
        t->name[c] = t->read.column[c].name;
        t->column[c] = t->read.column[c].value;
    }
    t->table = (sph_table){.size = sizeof t->table,
                           .n_columns = (uint32_t)n,
                           .n_rows = t->read.n,
                           .name = t->name,
                           .column = t->column,
                           .source = t->source};
    return 0;
}

int use_set_table(struct use *u, const struct document *d, const cJSON *member, struct error *e)
{
    struct use_table *t = calloc(1, sizeof *t);
    if (!t)
        return error_memory(e, "a table", sizeof *t);
    t->next = u->tables;
    u->tables = t;
    t->source = text_format("%s", plan_table_source(member));
    if (!t->source)
        return error_memory(e, "a name", 1);
    if (plan_table(&t->read, d, member, e) || publish(t, e))
        return -1;
    return config_set_table(&u->config, member->string, &t->table, e);
}
