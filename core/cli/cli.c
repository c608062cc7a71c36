/* cli/cli.c -- what the commands share. */
#include "cli/cli.h"

#include <stdio.h>

int cli_error(const struct error *e)
{
    fflush(stdout);
    fprintf(stderr, "sph: %s\n", e->text);
    return e->exit_code;
}
