/* scene/json_differ.c -- the first place where two scenes differ. Pure. */
#include "scene/json.h"
#include <string.h>

static bool skipped(const struct json_skip *skip, size_t n, const cJSON *object, int depth,
                    const cJSON *member)
{
    for (size_t i = 0; i < n; i++) {
        const char *in = skip[i].in;
        if (strcmp(skip[i].key, member->string) == 0 &&
            (in ? depth == 1 && object->string && strcmp(in, object->string) == 0 : depth == 0))
            return true;
    }
    return false;
}

static const cJSON *past_skipped(const struct json_skip *skip, size_t n, const cJSON *object,
                                 int depth, const cJSON *member)
{
    while (member && cJSON_IsObject(object) && skipped(skip, n, object, depth, member))
        member = member->next;
    return member;
}

static bool differ(const struct json_skip *skip, size_t n, int depth,
                   const struct json_difference *at, struct json_difference *out)
{
    const cJSON *a = at->was, *b = at->is;
    const int kinds = cJSON_False | cJSON_True | cJSON_NULL | cJSON_Number | cJSON_String |
                      cJSON_Array | cJSON_Object;
    *out = *at;
    if ((a->type & kinds) != (b->type & kinds))
        return true;
    if (cJSON_IsNumber(a))
        return a->valuedouble < b->valuedouble || a->valuedouble > b->valuedouble;
    if (cJSON_IsString(a))
        return strcmp(a->valuestring, b->valuestring) != 0;
    const cJSON *x = past_skipped(skip, n, a, depth, a->child);
    const cJSON *y = past_skipped(skip, n, b, depth, b->child);
    while (x && y) {
        if (cJSON_IsObject(a) && strcmp(x->string, y->string) != 0) {
            /* Gone, or new; if neither, the order has changed, which is that of the particles. */
            const bool gone = !cJSON_GetObjectItemCaseSensitive(b, x->string);
            const bool is_new = !cJSON_GetObjectItemCaseSensitive(a, y->string);
            *out = (struct json_difference){is_new && !gone ? NULL : x, gone ? NULL : y,
                                            !gone && !is_new};
            return true;
        }
        const struct json_difference next = {.was = x, .is = y};
        if (differ(skip, n, depth + 1, &next, out))
            return true;
        x = past_skipped(skip, n, a, depth, x->next);
        y = past_skipped(skip, n, b, depth, y->next);
    }
    *out = (struct json_difference){x, y, false};
    return x || y;
}

bool json_differ(const cJSON *was, const cJSON *is, const struct json_skip *skip, size_t n,
                 struct json_difference *out)
{
    const struct json_difference root = {.was = was, .is = is};
    return differ(skip, n, 0, &root, out);
}
