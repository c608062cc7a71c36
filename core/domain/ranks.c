/* domain/ranks.c -- MPI begun and ended. */
#include "domain/ranks.h"
#include "config.h"
#include <stdlib.h>

#if SPH_HAVE_MPI
#include <mpi.h>

/* Set by the launchers of Open MPI, by Slurm and by Hydra. */
static int launched(void)
{
    return getenv("OMPI_COMM_WORLD_SIZE") || getenv("PMI_SIZE") || getenv("PMIX_RANK");
}

int ranks_begin(int *argc, char ***argv, struct error *e)
{
    int size = 1, rank = 0;
    if (!launched())
        return 0;
    if (MPI_Init(argc, argv) != MPI_SUCCESS)
        return error_set(e, EXIT_RUN, "MPI does not start");
    MPI_Comm_size(MPI_COMM_WORLD, &size);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    if (size > 1) {
        error_set(e, EXIT_USAGE, "this version runs on one rank, not on %d; use --threads", size);
        if (rank > 0)
            e->text[0] = '\0'; /* the first one says it */
        return -1;
    }
    return 0;
}

void ranks_end(void)
{
    int begun = 0, ended = 0;
    MPI_Initialized(&begun);
    MPI_Finalized(&ended);
    if (begun && !ended)
        MPI_Finalize();
}

#else

int ranks_begin(int *argc, char ***argv, struct error *e)
{
    (void)argc;
    (void)argv;
    (void)e;
    return 0;
}

void ranks_end(void) {}

#endif
