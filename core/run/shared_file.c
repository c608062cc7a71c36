/* run/shared_file.c -- see run/shared_file.h. */
#include "run/shared_file.h"
#include "run/domain.h"
#include <stdlib.h>
#include <string.h>

int shared_text(const struct run *r, char **text, struct error *e)
{
    if (!r->domain)
        return 0;
    const bool mine = run_speaks(r);
    uint64_t n = mine ? strlen(*text) + 1 : 0;
    if (wire_tell(r->domain->wire, &n, sizeof n, e))
        return -1;
    char *copy = mine ? *text : malloc(n);
    if (!copy)
        return error_memory(e, "a text", n);
    *text = copy;
    return wire_tell(r->domain->wire, copy, n, e);
}

int shared_file_begin(struct run *r, const struct output *o, const char *name, char **temporary,
                      struct error *e)
{
    uint64_t nobody = 0;
    *temporary = run_speaks(r) ? output_begin(o, name) : NULL;
    if (run_speaks(r) && !*temporary)
        return error_memory(e, "a path", strlen(name));
    if (shared_text(r, temporary, e) || run_share_count(r, &nobody, e)) {
        free(*temporary);
        *temporary = NULL;
        return -1;
    }
    /* Through the sum everybody has come. Nobody goes on, and may fail, before all have seen that. */
    return run_domain_agree(r, 0, e);
}

int shared_file_end(struct run *r, const struct output *o, char *temporary, const char *name,
                    int status, struct error *e)
{
    status = run_domain_agree(r, status, e);
    if (!run_speaks(r)) {
        free(temporary);
    } else if (status) {
        output_drop(temporary);
    } else {
        status = output_commit(o, temporary, name, e);
        free(temporary);
    }
    return run_domain_agree(r, status, e);
}
