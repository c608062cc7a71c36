/* opencl/device_none.c -- stands in for device*.c in a build without OpenCL: no device opens. */
#include "config.h"

#include "opencl/device.h"

#if !SPH_HAVE_OPENCL

/* What can only be reached with an open device, of which there is none. */
static int none(struct error *e)
{
    return error_set(e, EXIT_USAGE, "this sph is built without OpenCL: --device cpu needs none");
}

int device_open(struct device **out, size_t number, struct error *e)
{
    (void)number;
    *out = NULL;
    return none(e);
}

int device_look(size_t number, struct device_facts *out, struct error *e)
{
    (void)number, (void)out;
    return none(e);
}

int device_open_part(struct device **out, size_t number, unsigned units, struct error *e)
{
    (void)units;
    return device_open(out, number, e);
}

bool device_failed(const struct device *d, bool *lost)
{
    (void)d;
    *lost = true;
    return true;
}

void device_close(struct device *d)
{
    (void)d;
}

const struct device_facts *device_facts(const struct device *d)
{
    static const struct device_facts nothing;

    (void)d;
    return &nothing;
}

int device_need_fp64(const struct device *d, struct error *e)
{
    (void)d;
    return none(e);
}

int device_reserve(struct device *d, struct device_buffer *b, size_t bytes, const char *what,
                   struct error *e)
{
    (void)d, (void)b, (void)bytes, (void)what;
    return none(e);
}

void device_release(struct device *d, struct device_buffer *b)
{
    (void)d;
    *b = (struct device_buffer){NULL, 0};
}

size_t device_bytes(const struct device *d, size_t *most)
{
    (void)d;
    if (most)
        *most = 0;
    return 0;
}

int device_write(struct device *d, struct device_buffer *b, size_t at, const void *data,
                 size_t bytes, struct error *e)
{
    (void)d, (void)b, (void)at, (void)data, (void)bytes;
    return none(e);
}

int device_read(struct device *d, const struct device_buffer *b, size_t at, void *data,
                size_t bytes, struct error *e)
{
    (void)d, (void)b, (void)at, (void)data, (void)bytes;
    return none(e);
}

int device_copy(struct device *d, struct device_buffer *to, size_t to_at,
                const struct device_buffer *from, size_t from_at, size_t bytes, struct error *e)
{
    (void)d, (void)to, (void)to_at, (void)from, (void)from_at, (void)bytes;
    return none(e);
}

int device_fill(struct device *d, struct device_buffer *b, size_t at, uint32_t value, size_t bytes,
                struct error *e)
{
    (void)d, (void)b, (void)at, (void)value, (void)bytes;
    return none(e);
}

int device_build(struct device *d, struct device_program **out, const char *text,
                 const char *options, const char *what, struct error *e)
{
    (void)d, (void)text, (void)options, (void)what;
    *out = NULL;
    return none(e);
}

const char *device_build_file(const struct device *d)
{
    (void)d;
    return NULL;
}

void device_program_free(struct device *d, struct device_program *p)
{
    (void)d, (void)p;
}

double device_build_seconds(const struct device *d, unsigned *cached, unsigned *built)
{
    (void)d;
    if (cached)
        *cached = 0;
    if (built)
        *built = 0;
    return 0;
}

int device_kernel(struct device *d, struct device_program *p, const char *name, const char *timed,
                  struct device_kernel **out, struct error *e)
{
    (void)d, (void)p, (void)name, (void)timed;
    *out = NULL;
    return none(e);
}

int device_launch(struct device *d, struct device_kernel *k, size_t items,
                  const struct device_arg *arg, size_t n_arg, struct error *e)
{
    (void)d, (void)k, (void)items, (void)arg, (void)n_arg;
    return none(e);
}

int device_finish(struct device *d, struct error *e)
{
    (void)d;
    return none(e);
}

const struct device_time *device_times(struct device *d, size_t *n)
{
    (void)d;
    *n = 0;
    return NULL;
}

size_t device_span(struct device *d, size_t k)
{
    (void)d, (void)k;
    return 0;
}

const struct device_span *device_spans(struct device *d, size_t *n)
{
    (void)d;
    *n = 0;
    return NULL;
}

int device_measure(struct device *d, struct device_rates *r, struct error *e)
{
    (void)d;
    *r = (struct device_rates){0};
    return none(e);
}

#endif
