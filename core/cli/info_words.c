/* cli/info_words.c -- words for the numbers of the ABI. */
#include "cli/info.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const char *info_type(uint32_t type)
{
    static const char *const name[] = {"?",      "scalar", "vector", "symmetric tensor",
                                       "matrix", "int32",  "int64"};

    return type < sizeof(name) / sizeof(name[0]) ? name[type] : name[0];
}

const char *info_access(uint32_t access, char *out, size_t size)
{
    static const struct {
        uint32_t bit;
        const char *word;
    } words[] = {{SPH_DST_READ, "read"},   {SPH_SRC_READ, "read at sources"},
                 {SPH_DST_WRITE, "write"}, {SPH_DST_SUM, "sum"},
                 {SPH_DST_MAX, "max"},     {SPH_DST_MIN, "min"},
                 {SPH_WORK, "work"},       {SPH_DST_SWEEP, "sweep alone"}};
    size_t n = 0;

    out[0] = '\0';
    for (size_t i = 0; i < sizeof(words) / sizeof(words[0]); i++)
        if ((access & words[i].bit) && n < size)
            n += (size_t)snprintf(out + n, size - n, "%s%s", n > 0 ? ", " : "", words[i].word);
    return out;
}

const char *info_default(const sph_param *p, char *out, size_t size)
{
    const char *word = p->choices;

    if (isnan(p->def)) {
        out[0] = '\0';
    } else if (!word) {
        snprintf(out, size, "%.9g", p->def);
    } else {
        for (double i = 0; i < p->def; i++)
            word += strcspn(word, "|") + 1;
        snprintf(out, size, "%.*s", (int)strcspn(word, "|"), word);
    }
    return out;
}
