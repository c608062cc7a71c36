/* render_file.c -- a cairo surface as a PNG that says that it is ours (io/output.h removes only
 * such). */
#include "config.h"

#include "io/output.h"
#include "io/render_parts.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define PNG_HEAD 33 /* bytes of signature and IHDR */

struct bytes {
    unsigned char *data;
    size_t n, room;
};

static cairo_status_t append(void *closure, const unsigned char *data, unsigned n)
{
    struct bytes *b = closure;
    if (b->room - b->n < n) {
        const size_t room = 2 * b->room + n + 4096;
        unsigned char *grown = realloc(b->data, room);
        if (!grown)
            return CAIRO_STATUS_NO_MEMORY;
        b->data = grown;
        b->room = room;
    }
    memcpy(b->data + b->n, data, n);
    b->n += n;
    return CAIRO_STATUS_SUCCESS;
}

static void put_big_endian(unsigned char *to, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        to[i] = (unsigned char)(value >> (24 - 8 * i));
}

/* CRC-32 as PNG has it (ISO 3309). */
static uint32_t crc(const unsigned char *data, size_t n)
{
    uint32_t c = 0xffffffffu;
    for (size_t i = 0; i < n; i++) {
        c ^= data[i];
        for (int k = 0; k < 8; k++)
            c = c & 1 ? 0xedb88320u ^ c >> 1 : c >> 1;
    }
    return ~c;
}

/* A text chunk right behind the header. */
static cairo_status_t insert_mark(struct bytes *b)
{
    static const char text[] = "tEXt" OUTPUT_PNG_KEY "\0" OUTPUT_PNG_MARK;
    const size_t n = sizeof text - 1;
    unsigned char chunk[4 + sizeof text - 1 + 4];
    put_big_endian(chunk, (uint32_t)(n - 4));
    memcpy(chunk + 4, text, n);
    put_big_endian(chunk + 4 + n, crc(chunk + 4, n));
    const cairo_status_t status = append(b, chunk, sizeof chunk); /* makes room */
    if (status)
        return status;
    memmove(b->data + PNG_HEAD + sizeof chunk, b->data + PNG_HEAD, b->n - sizeof chunk - PNG_HEAD);
    memcpy(b->data + PNG_HEAD, chunk, sizeof chunk);
    return CAIRO_STATUS_SUCCESS;
}

int png_write(const char *path, cairo_surface_t *surface, struct error *e)
{
    struct bytes png = {0};
    cairo_status_t status = cairo_surface_write_to_png_stream(surface, append, &png);
    if (!status)
        status = insert_mark(&png);
    int result;
    if (status)
        result =
            error_set(e, EXIT_RUN, "cannot write %s: %s", path, cairo_status_to_string(status));
    else
        result = output_write_path(path, png.data, png.n, e);
    free(png.data);
    return result;
}
