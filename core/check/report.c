/* check/report.c -- verdicts (see report.h). Touches nothing but its own lines and stdout. */
#include "check/report.h"

#include <cjson/cJSON.h>
#include <stdlib.h>
#include <string.h>

static const char *const shown[VERDICT_COUNT] = {"ok  ", "FAIL", "note"};
static const char *const word[VERDICT_COUNT] = {"ok", "fail", "note"};

int report_add(struct report *r, enum verdict v, const char *kind, const char *item,
               const char *check, const char *text, struct error *e)
{
    struct line *grown = realloc(r->line, (r->n + 1) * sizeof(*grown));
    struct line *line;

    if (!grown)
        return error_memory(e, "verdicts", (r->n + 1) * sizeof(*grown));
    r->line = grown;
    line = &r->line[r->n++];
    *line = (struct line){v, strdup(kind), strdup(item), strdup(check), strdup(text)};
    if (!line->kind || !line->item || !line->check || !line->text)
        return error_memory(e, "verdicts", strlen(text));
    r->count[v]++;
    if (r->print && (!r->quiet || v == VERDICT_FAIL)) {
        printf("%s %s %s  %s\n", shown[v], kind, item, text);
        fflush(stdout);
    }
    return 0;
}

void report_free(struct report *r)
{
    for (size_t i = 0; i < r->n; i++) {
        free(r->line[i].kind);
        free(r->line[i].item);
        free(r->line[i].check);
        free(r->line[i].text);
    }
    free(r->line);
    *r = (struct report){0};
}

void report_count(const struct report *r, FILE *out)
{
    const size_t notes = r->count[VERDICT_NOTE];

    fprintf(out, "%zu checks: %zu ok, %zu failed; %zu note%s\n",
            r->count[VERDICT_OK] + r->count[VERDICT_FAIL], r->count[VERDICT_OK],
            r->count[VERDICT_FAIL], notes, notes == 1 ? "" : "s");
}

static bool add_line(cJSON *array, const struct line *line)
{
    cJSON *o = cJSON_CreateObject();

    if (!cJSON_AddItemToArray(array, o)) {
        cJSON_Delete(o);
        return false;
    }
    return cJSON_AddStringToObject(o, "verdict", word[line->verdict]) &&
           cJSON_AddStringToObject(o, "kind", line->kind) &&
           cJSON_AddStringToObject(o, "item", line->item) &&
           cJSON_AddStringToObject(o, "check", line->check) &&
           cJSON_AddStringToObject(o, "text", line->text);
}

int report_json(const struct report *r, FILE *out, struct error *e)
{
    cJSON *array = cJSON_CreateArray();
    char *text = NULL;
    bool good = array != NULL;

    for (size_t i = 0; good && i < r->n; i++)
        good = add_line(array, &r->line[i]);
    if (good)
        text = cJSON_Print(array);
    cJSON_Delete(array);
    if (!text)
        return error_memory(e, "the JSON", r->n);
    fprintf(out, "%s\n", text);
    cJSON_free(text);
    return 0;
}
