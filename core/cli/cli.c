/* cli/cli.c -- what the commands share. */
#include "cli/cli.h"

#include <stdio.h>

int cli_error(const struct error *e)
{
    fflush(stdout);
    /* Of many ranks with the same error one has the words. */
    if (e->text[0])
        fprintf(stderr, "sph: %s\n", e->text);
    return e->exit_code;
}
