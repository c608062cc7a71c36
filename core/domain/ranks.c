/* domain/ranks.c -- MPI begun and ended, and errors that all ranks share. */
#include "domain/ranks.h"
#include "config.h"
#include <limits.h>
#include <stdlib.h>

#if SPH_HAVE_MPI
#include <mpi.h>

/* Of what launchers set; -1: none of it. */
static int number_of(const char *const *names)
{
    for (; *names; names++) {
        const char *text = getenv(*names);
        if (text && *text >= '0' && *text <= '9')
            return (int)strtol(text, NULL, 10);
    }
    return -1;
}

/* Open MPI, Hydra and Slurm's pmi2, Slurm's pmix. */
void ranks_launched(int *rank, int *size)
{
    static const char *const ranks[] = {"OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK", NULL};
    static const char *const sizes[] = {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", NULL};
    const int r = number_of(ranks), n = number_of(sizes);
    *rank = r > 0 ? r : 0;
    *size = n > *rank ? n : *rank + 1;
}

static int launched(void)
{
    return getenv("OMPI_COMM_WORLD_SIZE") || getenv("PMI_SIZE") || getenv("PMIX_RANK");
}

int ranks_begin(int *argc, char ***argv, struct error *e)
{
    if (!launched())
        return 0;
    int provided;
    if (MPI_Init_thread(argc, argv, MPI_THREAD_FUNNELED, &provided) != MPI_SUCCESS)
        return error_set(e, EXIT_RUN, "MPI does not start");
    if (provided < MPI_THREAD_FUNNELED) /* the first thread speaks while others compute */
        return error_set(e, EXIT_RUN, "this MPI is not for programs with threads");
    return 0;
}

void ranks_count(int *rank, int *size)
{
    int begun = 0, ended = 0;
    *rank = 0;
    *size = 1;
    MPI_Initialized(&begun);
    MPI_Finalized(&ended);
    if (!begun || ended)
        return;
    MPI_Comm_rank(MPI_COMM_WORLD, rank);
    MPI_Comm_size(MPI_COMM_WORLD, size);
}

int ranks_agree(int status, struct error *e)
{
    int rank, size;
    ranks_count(&rank, &size);
    if (size == 1)
        return status;
    /* Some may only have heard that another has failed: they have nothing to say. */
    const int speaks = status && e->text[0];
    int sum[2] = {status ? 1 : 0, speaks}, number[2] = {0, 0}, speaker = 0;
    int place = speaks ? rank : status ? size + rank : 2 * size;
    MPI_Allreduce(sum, number, 2, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
    MPI_Allreduce(&place, &speaker, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
    if (number[0] == 0)
        return 0;
    speaker %= size;
    if (rank == speaker && number[1] < size && e->text[0])
        error_prefix(e, "rank %d", rank); /* what all ranks meet needs no name */
    MPI_Bcast(e, (int)sizeof *e, MPI_BYTE, speaker, MPI_COMM_WORLD);
    return -1;
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

void ranks_launched(int *rank, int *size)
{
    *rank = 0;
    *size = 1;
}

void ranks_count(int *rank, int *size)
{
    *rank = 0;
    *size = 1;
}

int ranks_agree(int status, struct error *e)
{
    (void)e;
    return status;
}

void ranks_end(void) {}

#endif
