/* cli/cli.c -- what the commands share. */
#include "cli/cli.h"

#include "domain/ranks.h"

#include <stdio.h>

int cli_error(const struct error *e)
{
    int rank, size, mine, begun;
    ranks_launched(&rank, &size); /* all of them have the same sentence */
    ranks_count(&mine, &begun);
    fflush(stdout);
    if (rank == 0)
        fprintf(stderr, "sph: %s\n", e->text);
    /* Before MPI is begun nothing makes the others wait for it: an error of theirs would have it killed. */
    return rank > 0 && begun == 1 ? EXIT_DONE : e->exit_code;
}
