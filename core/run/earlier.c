/* run/earlier.c -- see earlier.h. */
#include "run/earlier.h"
#include "io/checkpoint.h"
#include <cjson/cJSON.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SUMMARY_MOST 1000000 /* bytes */

/* By its summary: who was killed has none. */
static bool has_ended(const struct output *o)
{
    char *path = output_path(o, "summary.json"), *text = malloc(SUMMARY_MOST);
    FILE *file = path && text ? fopen(path, "r") : NULL;
    const size_t n = file ? fread(text, 1, SUMMARY_MOST, file) : 0;
    cJSON *json = n ? cJSON_ParseWithLength(text, n) : NULL;
    const char *status = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(json, "status"));
    const bool ended = status && strcmp(status, "done") == 0;
    cJSON_Delete(json);
    if (file)
        fclose(file);
    free(text);
    free(path);
    return ended;
}

/* Whether a file is a good checkpoint. */
static bool look(struct earlier *was, const struct output *o, const char *name)
{
    struct checkpoint file;
    struct error ignored = {0};
    struct earlier found = {.any = true};
    char *path = output_path(o, name);
    bool good = path && access(path, F_OK) == 0 && checkpoint_open(&file, path, &ignored) == 0;
    if (good) {
        good = store_u64(&file.store, "step", &found.step, &ignored) == 0 &&
               store_f64(&file.store, "time", &found.time, &ignored) == 0;
        checkpoint_close(&file);
    }
    free(path);
    if (good)
        *was = found;
    return good;
}

void earlier_find(struct earlier *was, const struct output *o)
{
    *was = (struct earlier){0};
    look(was, o, OUTPUT_EARLIER);
}

int earlier_clear(struct earlier *was, const struct output *o, struct error *e)
{
    struct error ignored = {0};
    long long *step = NULL;
    char name[64] = OUTPUT_EARLIER;
    *was = (struct earlier){0};
    if (!has_ended(o)) {
        const long n = checkpoint_list(o->dir, &step, &ignored);
        struct earlier found = {0};
        earlier_find(was, o);
        for (long k = 0; k < n && !found.any; k++) {
            char one[64];
            output_checkpoint_name(one, sizeof one, (unsigned long long)step[k]);
            if (look(&found, o, one) && !(was->any && was->step > found.step)) {
                *was = found;
                memcpy(name, one, sizeof one);
            }
        }
        free(step);
    }
    if (output_clear_but(o, was->any ? name : NULL, e))
        return -1;
    if (was->any)
        fprintf(
            stderr,
            "sph: %s holds a checkpoint of step %llu, t = %g, of a run that did not end; it is kept as "
            "%s until this run has come as far: --resume %s/%s goes on from it\n",
            o->dir, (unsigned long long)was->step, was->time, OUTPUT_EARLIER, o->dir,
            OUTPUT_EARLIER);
    return 0;
}

void earlier_pass(struct earlier *was, const struct output *o, uint64_t step)
{
    char *path = was->any && step >= was->step ? output_path(o, OUTPUT_EARLIER) : NULL;
    if (path && unlink(path) == 0)
        was->any = false;
    free(path);
}
