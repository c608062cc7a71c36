/* scene/json_scan.h -- the grammar of JSON over a text: checks it, and says where each value
 * stands. */
#ifndef SCENE_JSON_SCAN_H
#define SCENE_JSON_SCAN_H

#include <stddef.h>

/* Offsets of a value and of its key (of the value again, where it has none). */
struct spot {
    size_t value, key;
};

struct scan {
    const char *text;
    size_t n, at;
    struct spot *spot; /* of every value, in the order of their beginnings; the caller frees it */
    size_t n_spot, capacity;
    size_t error_at; /* of a failure */
    char error[256];
};

/* Scans a whole text; a byte order mark before it is skipped. 0, or -1 with error and error_at. */
int scan_text(struct scan *s, const char *text, size_t n);
void scan_fini(struct scan *s);

/* Line and column, both from 1, the column in characters. */
void scan_line(const char *text, size_t offset, size_t *line, size_t *column);

#endif
