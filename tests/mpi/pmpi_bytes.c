/* tests/mpi/pmpi_bytes.c -- for LD_PRELOAD: counts what each communicator sends from rank to rank by MPI's own profiling
 * interface, and leaves it in $SPH_PMPI_OUT.RANK as the program ends: a line a communicator,
 * "messages bytes name". */
#include "config.h"
#if SPH_HAVE_MPI
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NAMES 64

static struct {
    char name[MPI_MAX_OBJECT_NAME];
    unsigned long long messages, bytes;
} counted[NAMES];

static void count(int n, MPI_Datatype type, int to, MPI_Comm comm)
{
    char name[MPI_MAX_OBJECT_NAME] = "";
    int length = 0, size = 0, rank = 0, k = 0;
    PMPI_Comm_get_name(comm, name, &length);
    PMPI_Comm_rank(comm, &rank);
    PMPI_Type_size(type, &size);
    while (k + 1 < NAMES && counted[k].name[0] && strcmp(counted[k].name, name) != 0)
        k++;
    if (to == rank || to == MPI_PROC_NULL)
        return;
    snprintf(counted[k].name, sizeof counted[k].name, "%s", name[0] ? name : "unnamed");
    counted[k].messages++;
    counted[k].bytes += (unsigned long long)n * (unsigned long long)size;
}

/* The ways in which one message can be sent at once: those that do not last, and are from rank to rank. What calls of all
 * ranks carry is not counted here. */
#define SENDS(which)                                                                               \
    int MPI_##which(const void *data, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm)    \
    {                                                                                              \
        count(n, type, to, comm);                                                                  \
        return PMPI_##which(data, n, type, to, tag, comm);                                         \
    }
#define BEGINS(which)                                                                              \
    int MPI_##which(const void *data, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm,    \
                    MPI_Request *request)                                                          \
    {                                                                                              \
        count(n, type, to, comm);                                                                  \
        return PMPI_##which(data, n, type, to, tag, comm, request);                                \
    }
SENDS(Send)
SENDS(Bsend)
SENDS(Rsend)
SENDS(Ssend)
BEGINS(Isend)
BEGINS(Ibsend)
BEGINS(Irsend)
BEGINS(Issend)

int MPI_Sendrecv(const void *data, int n, MPI_Datatype type, int to, int tag, void *in, int n_in,
                 MPI_Datatype type_in, int from, int tag_in, MPI_Comm comm, MPI_Status *status)
{
    count(n, type, to, comm);
    return PMPI_Sendrecv(data, n, type, to, tag, in, n_in, type_in, from, tag_in, comm, status);
}

int MPI_Finalize(void)
{
    const char *out = getenv("SPH_PMPI_OUT");
    char path[4096];
    int rank = 0;
    PMPI_Comm_rank(MPI_COMM_WORLD, &rank);
    snprintf(path, sizeof path, "%s.%d", out ? out : "pmpi", rank);
    FILE *file = fopen(path, "w");
    for (int k = 0; file && k < NAMES && counted[k].name[0]; k++)
        fprintf(file, "%llu %llu %s\n", counted[k].messages, counted[k].bytes, counted[k].name);
    if (file)
        fclose(file);
    return PMPI_Finalize();
}
#else
typedef int nothing; /* to count */
#endif
