/* domain/partition.c -- see partition.h. Zoltan asks for the points by calls of ours, and keeps its cuts; slabs
 * are slab.c's. */
#include "domain/partition.h"
#include "config.h"
#include "domain/slab.h"
#include <stdlib.h>

const char *const partitioner_name[PARTITIONERS] = {"rcb", "rib", "hsfc", "slab"};

#if SPH_HAVE_ZOLTAN
/* Not ours to warn about. */
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wstrict-prototypes"
#include <trilinos/zoltan.h>
#pragma GCC diagnostic pop

struct partition {
    struct Zoltan_Struct *zoltan; /* NULL: slabs */
    struct slab slab;
    enum partitioner which;
    int dim;
    /* While it cuts. */
    const double *const *x;
    const float *weight;
    size_t n;
};

/* A place as it is shown to Zoltan: the axes a little askew. Particles of a lattice stand in planes, and a cut
 * that runs along one has all of it on one side; so it divides it. */
static void askew(int dim, const double *x, double *out)
{
    static const double slope[3][3] = {
        {1.0, 0.0137, 0.0071}, {-0.0137, 1.0, 0.0113}, {-0.0071, -0.0113, 1.0}};
    for (int a = 0; a < dim; a++) {
        out[a] = 0.0;
        for (int b = 0; b < dim; b++)
            out[a] += slope[a][b] * x[b];
    }
}

static int ask_dimensions(void *data, int *status)
{
    *status = ZOLTAN_OK;
    return ((struct partition *)data)->dim;
}

static int ask_number(void *data, int *status)
{
    *status = ZOLTAN_OK;
    return (int)((struct partition *)data)->n;
}

static void ask_objects(void *data, int n_global, int n_local, ZOLTAN_ID_PTR global,
                        ZOLTAN_ID_PTR local, int n_weight, float *weight, int *status)
{
    const struct partition *p = data;
    (void)n_global;
    (void)n_local;
    (void)n_weight;
    for (size_t i = 0; i < p->n; i++) {
        global[i] = local[i] = (ZOLTAN_ID_TYPE)i;
        weight[i] = p->weight[i];
    }
    *status = ZOLTAN_OK;
}

static void ask_places(void *data, int n_global, int n_local, int n, ZOLTAN_ID_PTR global,
                       ZOLTAN_ID_PTR local, int dim, double *x, int *status)
{
    const struct partition *p = data;
    (void)n_global;
    (void)n_local;
    (void)global;
    for (int k = 0; k < n; k++) {
        double at[3];
        for (int a = 0; a < dim; a++)
            at[a] = p->x[a][local[k]];
        askew(dim, at, x + k * dim);
    }
    *status = ZOLTAN_OK;
}

static int set(struct partition *p, enum partitioner which)
{
    static const char *const method[PARTITION_SLAB] = {"RCB", "RIB", "HSFC"};
    const char *const list[][2] = {{"DEBUG_LEVEL", "0"}, /* else it prints */
                                   {"LB_METHOD", method[which]}, {"NUM_GID_ENTRIES", "1"},
                                   {"NUM_LID_ENTRIES", "1"},     {"OBJ_WEIGHT_DIM", "1"},
                                   {"RETURN_LISTS", "NONE"},     {"KEEP_CUTS", "1"},
                                   {"IMBALANCE_TOL", "1.002"}};
    int status = ZOLTAN_OK;
    for (size_t k = 0; k < sizeof list / sizeof list[0] && status == ZOLTAN_OK; k++)
        status = Zoltan_Set_Param(p->zoltan, list[k][0], list[k][1]);
    if (status == ZOLTAN_OK)
        status = Zoltan_Set_Num_Geom_Fn(p->zoltan, ask_dimensions, p);
    if (status == ZOLTAN_OK)
        status = Zoltan_Set_Geom_Multi_Fn(p->zoltan, ask_places, p);
    if (status == ZOLTAN_OK)
        status = Zoltan_Set_Num_Obj_Fn(p->zoltan, ask_number, p);
    if (status == ZOLTAN_OK)
        status = Zoltan_Set_Obj_List_Fn(p->zoltan, ask_objects, p);
    return status == ZOLTAN_OK ? 0 : -1;
}

int partition_open(struct partition **out, enum partitioner which, int dim, struct error *e)
{
    struct partition *p = *out = calloc(1, sizeof *p);
    float version;
    if (!p)
        return error_memory(e, "the domain", sizeof *p);
    p->dim = dim;
    p->which = which;
    if (which == PARTITION_SLAB)
        return slab_open(&p->slab, dim, e);
    if (Zoltan_Initialize(0, NULL, &version) == ZOLTAN_OK)
        p->zoltan = Zoltan_Create(MPI_COMM_WORLD);
    return p->zoltan && set(p, which) == 0 ? 0 : error_set(e, EXIT_RUN, "Zoltan does not start");
}

void partition_close(struct partition *p)
{
    if (p && p->zoltan)
        Zoltan_Destroy(&p->zoltan);
    if (p)
        slab_close(&p->slab);
    free(p);
}

int partition_cut(struct partition *p, const double *const *x, const float *weight, size_t n,
                  struct error *e)
{
    int changes, n_gid, n_lid, n_import, n_export;
    ZOLTAN_ID_PTR import_global, import_local, export_global, export_local;
    int *import_from, *import_part, *export_to, *export_part;
    p->x = x;
    p->weight = weight;
    p->n = n;
    if (!p->zoltan)
        return slab_cut(&p->slab, x, weight, n, e);
    const int status = Zoltan_LB_Partition(
        p->zoltan, &changes, &n_gid, &n_lid, &n_import, &import_global, &import_local, &import_from,
        &import_part, &n_export, &export_global, &export_local, &export_to, &export_part);
    if (status != ZOLTAN_OK && status != ZOLTAN_WARN)
        return error_set(e, EXIT_RUN, "Zoltan does not cut the domain (%d)", status);
    Zoltan_LB_Free_Part(&import_global, &import_local, &import_from, &import_part);
    Zoltan_LB_Free_Part(&export_global, &export_local, &export_to, &export_part);
    return 0;
}

/* Zoltan can do so for bisection by coordinates alone. */
int partition_store(struct partition *p, struct store *s, struct error *e)
{
    if (!p->zoltan)
        return slab_store(&p->slab, s, e);
    if (p->which != PARTITION_RCB)
        return 0;
    size_t n = Zoltan_Serialize_Size(p->zoltan);
    char *cuts = calloc(n + 1, 1);
    int status = cuts ? 0 : error_memory(e, "the domain", n);
    if (!status && Zoltan_Serialize(p->zoltan, n, cuts) != ZOLTAN_OK)
        status = error_set(e, EXIT_RUN, "Zoltan does not tell how it has cut the domain");
    if (!status)
        status = store_array(s, "cuts", STORE_U8, &cuts, &n, 0, e);
    free(cuts);
    return status;
}

int partition_restore(struct partition *p, struct store *s, bool *there, struct error *e)
{
    size_t n = 0;
    char *cuts = NULL;
    if (!p->zoltan) {
        *there = store_has(s, "slabs");
        return *there ? slab_store(&p->slab, s, e) : 0;
    }
    *there = p->which == PARTITION_RCB && store_has(s, "cuts");
    if (!*there)
        return 0;
    int status = store_array(s, "cuts", STORE_U8, &cuts, &n, 0, e);
    if (!status && Zoltan_Deserialize(p->zoltan, n, cuts) != ZOLTAN_OK)
        status = store_broken(s, e, "the cuts of the domain");
    free(cuts);
    return status;
}

int partition_owner(const struct partition *p, const double *x)
{
    double at[3] = {0.0, 0.0, 0.0};
    int rank = 0, part = 0;
    if (!p->zoltan)
        return slab_owner(&p->slab, x);
    askew(p->dim, x, at);
    if (Zoltan_LB_Point_PP_Assign(p->zoltan, at, &rank, &part) != ZOLTAN_OK)
        return 0;
    return rank;
}

#else

int partition_open(struct partition **p, enum partitioner which, int dim, struct error *e)
{
    (void)which;
    (void)dim;
    *p = NULL;
    return error_set(e, EXIT_USAGE, "built without Zoltan: one rank only");
}

void partition_close(struct partition *p)
{
    (void)p;
}

int partition_cut(struct partition *p, const double *const *x, const float *weight, size_t n,
                  struct error *e)
{
    (void)p;
    (void)x;
    (void)weight;
    (void)n;
    return error_set(e, EXIT_USAGE, "built without Zoltan: one rank only");
}

int partition_store(struct partition *p, struct store *s, struct error *e)
{
    (void)p;
    (void)s;
    (void)e;
    return 0;
}

int partition_restore(struct partition *p, struct store *s, bool *there, struct error *e)
{
    (void)p;
    (void)s;
    (void)e;
    *there = false;
    return 0;
}

int partition_owner(const struct partition *p, const double *x)
{
    (void)p;
    (void)x;
    return 0;
}

#endif
