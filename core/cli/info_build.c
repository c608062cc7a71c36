/* cli/info_build.c -- `sph info --build` and `--devices`: what is built in, what there is. */
#include "config.h"

#include "cli/info.h"
#include "opencl/devices.h"

#include <cairo.h>
#include <cjson/cJSON.h>
#include <gnu/libc-version.h>
#include <hdf5.h>
#include <muParserDLL.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#if SPH_HAVE_MPI
#include <mpi.h>
#endif
#if SPH_HAVE_ZOLTAN
#include <trilinos/zoltan.h>
#endif

static void line(const char *what, const char *version)
{
    printf("%-12s %s\n", what, version);
}

static void mpi_line(void)
{
#if SPH_HAVE_MPI
    char text[MPI_MAX_LIBRARY_VERSION_STRING];
    int n = 0;

    /* One of the few calls that are allowed before MPI_Init. Of a long text the first clause. */
    MPI_Get_library_version(text, &n);
    text[strcspn(text, ",\n")] = '\0';
    line("MPI", text);
#else
    line("MPI", "not built in");
#endif
}

static void zoltan_line(void)
{
#if SPH_HAVE_ZOLTAN
    char text[32];

    snprintf(text, sizeof(text), "%g", ZOLTAN_VERSION_NUMBER);
    line("Zoltan", text);
#else
    line("Zoltan", "not built in");
#endif
}

static void hdf5_line(void)
{
    unsigned major = 0, minor = 0, release = 0;
    char text[64];

    H5get_libversion(&major, &minor, &release);
    snprintf(text, sizeof(text), "%u.%u.%u, %s", major, minor, release,
#ifdef H5_HAVE_PARALLEL
             "parallel"
#else
             "serial"
#endif
    );
    line("HDF5", text);
}

static void muparser_line(void)
{
    muParserHandle_t parser = mupCreate(muBASETYPE_FLOAT);

    line("muParser", parser ? mupGetVersion(parser) : "?");
    if (parser)
        mupRelease(parser);
}

static void opencl_line(void)
{
    struct opencl_device *device = NULL;
    size_t n = 0;
    char text[64];

    if (!opencl_is_built()) {
        line("OpenCL", "not built in");
        return;
    }
    opencl_devices(&device, &n, NULL);
    snprintf(text, sizeof(text), "%zu device%s (`sph info --devices' lists them)", n,
             n == 1 ? "" : "s");
    line("OpenCL", text);
    free(device);
}

void info_build(void)
{
    char abi[32];

    snprintf(abi, sizeof(abi), "%u.%u", SPH_ABI_MAJOR, SPH_ABI_MINOR);
    line("sph", PACKAGE_VERSION);
    line("plugin ABI", abi);
#if defined(__clang__)
    line("compiler", __VERSION__);
#else
    line("compiler", "GCC " __VERSION__);
#endif
    line("C library", gnu_get_libc_version());
#ifdef _OPENMP
    snprintf(abi, sizeof(abi), "%d", _OPENMP);
    line("OpenMP", abi);
#else
    line("OpenMP", "not built in");
#endif
    mpi_line();
    zoltan_line();
    hdf5_line();
    opencl_line();
    line("cJSON", cJSON_Version());
    muparser_line();
    line("cairo", cairo_version_string());
}

/* "pthread-skylake-avx512-AMD EPYC": at most so many columns, cut with dots. */
static void cut(char *text, size_t columns)
{
    if (strlen(text) > columns)
        memcpy(text + columns - 3, "...", 4);
}

static void device_lines(size_t number, struct opencl_device *d)
{
    const double gib = 1024. * 1024. * 1024.;

    cut(d->name, 68);
    cut(d->platform, 32);
    cut(d->driver, 24);
    printf("opencl:%zu  %s\n", number, d->name);
    printf("          %s, %u compute units, %s double precision\n", d->type, d->units,
           d->fp64 ? "has" : "no");
    printf("          %.1f GiB of memory, at most %.1f GiB in one buffer\n",
           (double)d->memory / gib, (double)d->largest / gib);
    printf("          %s, driver %s\n", d->platform, d->driver);
}

int info_devices(struct error *e)
{
    struct opencl_device *d;
    size_t n;

    if (!opencl_is_built())
        return error_set(e, EXIT_USAGE, "OpenCL is not built in: configure it --with-opencl");
    if (opencl_devices(&d, &n, e))
        return -1;
    if (n == 0)
        puts("No OpenCL device: install the driver of a GPU, or pocl-opencl-icd, which makes\n"
             "one of the processor. `--device cpu' needs none.");
    for (size_t i = 0; i < n; i++)
        device_lines(i, &d[i]);
    if (n > 0)
        puts("\n`sph SCENE --device opencl:N' computes on device N; it needs double precision.");
    free(d);
    return 0;
}
