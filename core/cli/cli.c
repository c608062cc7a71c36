/* cli/cli.c -- what the commands share. */
#include "cli/cli.h"

#include "domain/ranks.h"

#include <stdio.h>

int cli_error(const struct error *e)
{
    int rank, size;
    ranks_launched(&rank, &size); /* all of them have the same sentence */
    fflush(stdout);
    if (rank == 0)
        fprintf(stderr, "sph: %s\n", e->text);
    return e->exit_code;
}
