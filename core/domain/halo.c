/* domain/halo.c -- who needs whom (see halo.h); what is then sent is halo_columns.c's. */
#include "domain/halo.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TILES 512 /* boxes, at most, by which a rank tells where an array's destinations stand */
#define ROW 8     /* tiles that are looked at together first */
#define BLOCK 64  /* sources that are looked at together */
#define SLACK 1.005

/* A box, and how far what is in it reaches. Without anything in it lo is above hi. */
struct tile {
    double lo[3], hi[3], reach;
};

/* -- Opened and closed -------- */

int halo_open(struct halo *h, struct wire *w, size_t n_array, struct error *e)
{
    *h = (struct halo){.wire = w, .n_array = n_array};
    h->image = calloc(n_array + 1, sizeof *h->image);
    h->n_ghost = calloc(2 * n_array + 1, sizeof *h->n_ghost);
    if (!h->image || !h->n_ghost)
        return error_memory(e, "the domain", n_array);
    h->image_capacity = h->n_ghost + n_array;
    return 0;
}

static void peers_drop(struct halo *h)
{
    for (size_t k = 0; k < h->n_peer; k++) {
        struct halo_peer *q = &h->peer[k];
        for (size_t a = 0; q->part && a < h->n_array; a++) {
            free(q->part[a].send);
            free(q->part[a].image);
        }
        free(q->part);
        free(q->out);
        free(q->in);
    }
    h->n_peer = 0;
}

void halo_close(struct halo *h)
{
    peers_drop(h);
    for (size_t a = 0; h->image && a < h->n_array; a++)
        free(h->image[a]);
    free(h->image);
    free(h->n_ghost);
    free(h->peer);
    free(h->parcel);
    *h = (struct halo){0};
}

static int peer_add(struct halo *h, int rank, struct error *e)
{
    if (h->n_peer == h->peer_capacity) {
        const size_t capacity = 2 * h->peer_capacity + 8;
        struct halo_peer *peer = realloc(h->peer, capacity * sizeof *peer);
        if (!peer)
            return error_memory(e, "the domain", capacity * sizeof *peer);
        h->peer = peer;
        struct parcel *parcel = realloc(h->parcel, 2 * capacity * sizeof *parcel);
        if (!parcel)
            return error_memory(e, "the domain", 2 * capacity * sizeof *parcel);
        h->parcel = parcel;
        h->peer_capacity = capacity;
    }
    h->peer[h->n_peer] =
        (struct halo_peer){.rank = rank, .part = calloc(h->n_array + 1, sizeof(struct halo_part))};
    return h->peer[h->n_peer++].part ? 0 : error_memory(e, "the domain", h->n_array);
}

/* -- Boxes -------- */

static struct tile tile_none(int dim)
{
    struct tile t = {.reach = 0.0};
    for (int a = 0; a < 3; a++) {
        t.lo[a] = a < dim ? INFINITY : 0.0;
        t.hi[a] = a < dim ? -INFINITY : 0.0;
    }
    return t;
}

static inline void tile_add(struct tile *t, const struct cloud *c, size_t i, double factor)
{
    const double reach = factor * c->scale * c->h[i];
    t->reach = reach > t->reach ? reach : t->reach;
    for (int a = 0; a < c->dim; a++) {
        const double x = c->x[a][i];
        t->lo[a] = x < t->lo[a] ? x : t->lo[a];
        t->hi[a] = x > t->hi[a] ? x : t->hi[a];
    }
}

static struct tile tile_of(const struct cloud *c, size_t first, size_t end, double factor)
{
    struct tile t = tile_none(c->dim);
    for (size_t i = first; i < end; i++)
        tile_add(&t, c, i, factor);
    return t;
}

static void tile_join(struct tile *t, const struct tile *other)
{
    t->reach = other->reach > t->reach ? other->reach : t->reach;
    for (int a = 0; a < 3; a++) {
        t->lo[a] = other->lo[a] < t->lo[a] ? other->lo[a] : t->lo[a];
        t->hi[a] = other->hi[a] > t->hi[a] ? other->hi[a] : t->hi[a];
    }
}

/* As an image of a box. */
static struct tile tile_image(const struct box *box, struct tile t, unsigned code)
{
    for (int a = 0; a < box->dim; a++) {
        const unsigned image = code >> 2 * a & 3u;
        if (!image || !(t.lo[a] <= t.hi[a]))
            continue;
        const double p = sides_image(box, a, image, t.lo[a]),
                     q = sides_image(box, a, image, t.hi[a]);
        t.lo[a] = fmin(p, q);
        t.hi[a] = fmax(p, q);
    }
    return t;
}

/* Whether sources from lo to hi, that reach so far, may be within reach of destinations in a box. */
static inline bool box_near(const double *lo, const double *hi, double reach,
                            const struct tile *dst, bool symmetric)
{
    double gap2 = 0.0;
    reach = symmetric && reach > dst->reach ? reach : dst->reach;
    for (int a = 0; a < 3; a++) {
        const double below = dst->lo[a] - hi[a], above = lo[a] - dst->hi[a];
        const double gap = below > above ? below : above;
        gap2 += gap > 0.0 ? gap * gap : 0.0;
    }
    return gap2 <= reach * reach; /* of empty ones gaps are infinite */
}

static bool near(const struct tile *src, const struct tile *dst, bool symmetric)
{
    return box_near(src->lo, src->hi, src->reach, dst, symmetric);
}

/* All codes of images that there are, 0 first; how many: 27 at most. */
static size_t codes_of(const struct box *box, unsigned code[27])
{
    size_t n = 1;
    code[0] = 0;
    for (int a = 0; box->bounded && a < box->dim; a++) {
        const size_t before = n;
        for (unsigned image = IMAGE_LOW; image <= IMAGE_HIGH; image++)
            for (size_t k = 0; sides_has_image(box, a, image) && k < before; k++)
                code[n++] = code[k] | image << 2 * a;
    }
    return n;
}

/* -- Making -------- */

struct making {
    struct halo *h;
    const struct halo_job *job;
    unsigned code[27];
    size_t n_code, n_cloud;
    struct tile *mine;   /* of this rank's clouds one after the other */
    size_t n_mine;       /* of all of them */
    struct tile *block;  /* [n_block]: its particles, BLOCK at a time, of all clouds */
    size_t *first_block; /* [cloud + 1] */
    struct tile *whole;  /* [rank * n_cloud + cloud]: all of a rank's */
    uint64_t *n_tile;    /* [rank * n_cloud + cloud] */
    /* Of the peer at hand. */
    struct tile *tile; /* of each of its clouds one after the other */
    size_t *first;     /* [n_cloud + 1] */
    struct tile *row;  /* [tile / ROW]: of tiles, whichever clouds they are of */
};

static const struct cloud *cloud_at(const struct making *m, size_t frame, size_t array)
{
    return &m->job->cloud[frame * m->job->n_array + array];
}

/* Whether `holder` may have sources for destinations of `seeker`. */
static bool ranks_near(const struct making *m, int holder, int seeker)
{
    for (size_t k = 0; k < m->job->n_want; k++) {
        const struct halo_want *w = &m->job->want[k];
        const size_t at = w->frame * m->job->n_array;
        const struct tile *dst = &m->whole[(size_t)seeker * m->n_cloud + at + w->dst];
        const struct tile src = m->whole[(size_t)holder * m->n_cloud + at + w->src];
        for (size_t c = holder == seeker; c < (w->frame ? 1 : m->n_code); c++) {
            const struct tile image = tile_image(m->job->box, src, m->code[c]);
            if (near(&image, dst, w->symmetric))
                return true;
        }
    }
    return false;
}

/* -- This rank's -------- */

/* Cells over a box, as cubic as it goes, no more than TILES. */
struct cells {
    double lo[3], scale[3];
    size_t n[3];
};

static struct cells cells_over(const struct tile *whole, int dim)
{
    struct cells c = {.n = {1, 1, 1}};
    double volume = 1.0, edge;
    int axes = 0;
    for (int a = 0; a < dim; a++) {
        const double length = whole->hi[a] - whole->lo[a];
        volume *= length > 0.0 ? length : 1.0;
        axes += length > 0.0;
        c.lo[a] = whole->lo[a];
    }
    edge = axes ? pow(volume / TILES, 1.0 / axes) : 1.0;
    if (!isfinite(edge)) /* somebody is nowhere: whoever makes lists says so */
        axes = 0;
    for (bool fits = false; axes && !fits; edge *= 1.1) {
        double n = 1.0;
        for (int a = 0; a < dim; a++)
            n *= 1.0 + floor((whole->hi[a] - whole->lo[a]) / edge);
        fits = n <= TILES;
        for (int a = 0; fits && a < dim; a++) {
            c.n[a] = 1 + (size_t)((whole->hi[a] - whole->lo[a]) / edge);
            c.scale[a] = 1.0 / edge;
        }
    }
    return c;
}

static size_t cell_of(const struct cells *c, const struct cloud *cloud, size_t i)
{
    size_t at = 0;
    for (int a = cloud->dim - 1; a >= 0; a--) {
        const double q = (cloud->x[a][i] - c->lo[a]) * c->scale[a];
        at = at * c->n[a] + (q < (double)c->n[a] ? (size_t)q : c->n[a] - 1);
    }
    return at;
}

/* Blocks of a cloud's particles; then its tiles, behind those there are: none of them is empty. */
static size_t survey(const struct making *m, size_t cloud, struct tile *tile)
{
    const struct cloud *c = &m->job->cloud[cloud];
    const double factor = m->job->factor * SLACK;
    struct tile whole = tile_none(c->dim);
    size_t n = 0;
    for (size_t b = m->first_block[cloud]; b < m->first_block[cloud + 1]; b++) {
        const size_t first = (b - m->first_block[cloud]) * BLOCK;
        m->block[b] = tile_of(c, first, first + BLOCK < c->n ? first + BLOCK : c->n, factor);
        tile_join(&whole, &m->block[b]);
    }
    if (!c->n)
        return 0;
    const struct cells cells = cells_over(&whole, c->dim);
    const size_t all = cells.n[0] * cells.n[1] * cells.n[2];
    for (size_t t = 0; t < all; t++)
        tile[t] = tile_none(c->dim);
    for (size_t i = 0; i < c->n; i++)
        tile_add(&tile[cell_of(&cells, c, i)], c, i, factor);
    for (size_t t = 0; t < all; t++)
        if (tile[t].lo[0] <= tile[t].hi[0])
            tile[n++] = tile[t];
    return n;
}

/* What all ranks know of each other. */
static int introduce(struct making *m, struct error *e)
{
    struct wire *w = m->h->wire;
    const size_t ranks = (size_t)wire_size(w), n = m->n_cloud;
    struct mine {
        struct tile tile;
        uint64_t n;
    } *mine = calloc(n * (ranks + 1), sizeof *mine), *all = mine + n;
    size_t blocks = 0;
    m->whole = malloc(ranks * n * sizeof *m->whole + 1);
    m->n_tile = malloc(ranks * n * sizeof *m->n_tile + 1);
    for (size_t k = 0; k < n; k++) {
        m->first_block[k] = blocks;
        blocks += (m->job->cloud[k].n + BLOCK - 1) / BLOCK;
    }
    m->first_block[n] = blocks;
    m->block = malloc((blocks + 1) * sizeof *m->block);
    m->mine = malloc((n * TILES + 1) * sizeof *m->mine);
    if (!mine || !m->whole || !m->n_tile || !m->block || !m->mine) {
        free(mine);
        return error_memory(e, "the domain", ranks * n * sizeof *mine);
    }
    for (size_t k = 0; k < n; k++) {
        mine[k].n = survey(m, k, m->mine + m->n_mine);
        mine[k].tile = tile_none(m->job->cloud[k].dim);
        for (size_t t = 0; t < mine[k].n; t++)
            tile_join(&mine[k].tile, &m->mine[m->n_mine++]);
    }
    const int status = wire_gather(w, mine, n * sizeof *mine, all, e);
    for (size_t k = 0; !status && k < ranks * n; k++) {
        m->whole[k] = all[k].tile;
        m->n_tile[k] = all[k].n;
    }
    if (!status)
        free(mine);
    return status;
}

/* -- Who is needed -------- */

static int part_add(struct halo_part *p, size_t i, unsigned code, struct error *e)
{
    if (p->n_send == p->send_capacity) {
        const size_t capacity = 2 * p->send_capacity + 256;
        uint32_t *send = realloc(p->send, capacity * sizeof *send);
        p->send = send ? send : p->send;
        uint8_t *image = realloc(p->image, capacity);
        p->image = image ? image : p->image;
        if (!send || !image)
            return error_memory(e, "ghosts", capacity * sizeof *send);
        p->send_capacity = capacity;
    }
    p->send[p->n_send] = (uint32_t)i;
    p->image[p->n_send++] = (uint8_t)code;
    return 0;
}

/* Boxes of the peer that some of a block of sources may be near. */
struct candidates {
    const struct tile **tile;
    const struct halo_want **want;
    size_t n;
};

/* A source as an image, and how far it reaches. */
struct point {
    double x[3], reach;
};

static struct point point_at(const struct making *m, const struct cloud *c, size_t i, unsigned code)
{
    struct point p = {.reach = m->job->factor * SLACK * c->scale * c->h[i]};
    for (int a = 0; a < c->dim; a++) {
        const unsigned image = code >> 2 * a & 3u;
        p.x[a] = image ? sides_image(m->job->box, a, image, c->x[a][i]) : c->x[a][i];
    }
    return p;
}

static bool wanted(const struct making *m, const struct candidates *c, size_t i, unsigned code)
{
    struct point p = {{0.0}, 0.0};
    for (size_t k = 0; k < c->n; k++) {
        const struct halo_want *w = c->want[k];
        if (k == 0 || w != c->want[k - 1])
            p = point_at(m, cloud_at(m, w->frame, w->src), i, code);
        if (box_near(p.x, p.x, p.reach, c->tile[k], w->symmetric))
            return true;
    }
    return false;
}

/* Of a block of an array's sources, as one image: those that the peer needs. */
static int look_at_block(const struct making *m, struct halo_peer *q, size_t array, size_t block,
                         unsigned code, struct candidates *c, struct error *e)
{
    struct halo_part *part = &q->part[array];
    const struct tile *whole = m->whole + (size_t)q->rank * m->n_cloud;
    size_t end = 0;
    c->n = 0;
    for (size_t k = 0; k < m->job->n_want; k++) {
        const struct halo_want *w = &m->job->want[k];
        const size_t at = w->frame * m->job->n_array, dst = at + w->dst, src = at + w->src;
        if (w->src != array || (w->frame && code) ||
            block >= m->first_block[src + 1] - m->first_block[src])
            continue;
        struct tile all = m->block[m->first_block[src] + block];
        all = code ? tile_image(m->job->box, all, code) : all;
        if (!near(&all, &whole[dst], w->symmetric))
            continue;
        for (size_t t = m->first[dst], far; t < m->first[dst + 1]; t = far + 1) {
            far = t | (ROW - 1);
            if (!near(&all, &m->row[t / ROW], w->symmetric))
                continue;
            for (; t <= far && t < m->first[dst + 1]; t++)
                if (near(&all, &m->tile[t], w->symmetric)) {
                    c->tile[c->n] = &m->tile[t];
                    c->want[c->n++] = w;
                    end = m->job->cloud[src].n;
                }
        }
    }
    const size_t first = block * BLOCK;
    end = first + BLOCK < end ? first + BLOCK : end;
    for (size_t i = first; c->n && i < end; i++)
        if (wanted(m, c, i, code) && part_add(part, i, code, e))
            return -1;
    return 0;
}

/* By code, and of one code as it is: by particle. So the order of ghosts tells nothing of how particles stood in blocks,
 * and is the same when a halo is made again. */
static int part_sort(struct halo_part *p, struct error *e)
{
    size_t place[65] = {0};
    uint32_t *send = malloc((p->n_send + 1) * sizeof *send);
    uint8_t *image = malloc(p->n_send + 1);
    if (!send || !image) {
        free(send);
        free(image);
        return error_memory(e, "ghosts", p->n_send * sizeof *send);
    }
    for (size_t i = 0; i < p->n_send; i++)
        place[p->image[i] + 1]++;
    for (size_t code = 0; code < 64; code++)
        place[code + 1] += place[code];
    for (size_t i = 0; i < p->n_send; i++) {
        const size_t at = place[p->image[i]]++;
        send[at] = p->send[i];
        image[at] = p->image[i];
    }
    free(p->send);
    free(p->image);
    p->send = send;
    p->image = image;
    p->send_capacity = p->n_send + 1;
    return 0;
}

static int look_for_peer(const struct making *m, struct halo_peer *q, struct error *e)
{
    const size_t most = m->first[m->n_cloud] * m->job->n_want + 1;
    const bool self = q->rank == wire_rank(m->h->wire);
    struct candidates c = {.tile = malloc(most * sizeof *c.tile),
                           .want = malloc(most * sizeof *c.want)};
    int status = c.tile && c.want ? 0 : error_memory(e, "the domain", most * sizeof *c.tile);
    for (size_t a = 0; !status && a < m->job->n_array; a++) {
        size_t n = 0;
        for (size_t f = 0; f < m->job->n_frame; f++)
            n = cloud_at(m, f, a)->n > n ? cloud_at(m, f, a)->n : n;
        for (size_t b = 0; !status && b * BLOCK < n; b++)
            for (size_t k = self; !status && k < m->n_code; k++)
                status = look_at_block(m, q, a, b, m->code[k], &c, e);
        if (!status)
            status = part_sort(&q->part[a], e);
    }
    free(c.tile);
    free(c.want);
    return status;
}

/* -- Peers -------- */

/* Tiles of a rank's clouds: where each begins. */
static void lay_tiles(const struct making *m, int rank, size_t *first)
{
    first[0] = 0;
    for (size_t k = 0; k < m->n_cloud; k++)
        first[k + 1] = first[k] + m->n_tile[(size_t)rank * m->n_cloud + k];
}

static int find_peers(struct making *m, struct error *e)
{
    struct halo *h = m->h;
    const int me = wire_rank(h->wire), ranks = wire_size(h->wire);
    peers_drop(h);
    for (int r = 0; r < ranks; r++)
        if ((ranks_near(m, me, r) || ranks_near(m, r, me)) && peer_add(h, r, e))
            return -1;
    return 0;
}

/* Each peer's tiles, where this rank may hold sources for it: tile[k], in memory of its own. */
static int trade_tiles(struct making *m, struct tile **tile, struct error *e)
{
    struct halo *h = m->h;
    const int me = wire_rank(h->wire);
    size_t n_send = 0, n_receive = 0;
    struct parcel *receive = h->parcel + h->n_peer;
    for (size_t k = 0; k < h->n_peer; k++) {
        const int r = h->peer[k].rank;
        if (r != me && ranks_near(m, r, me))
            h->parcel[n_send++] = (struct parcel){r, m->mine, m->n_mine * sizeof *m->mine};
        if (!ranks_near(m, me, r))
            continue;
        lay_tiles(m, r, m->first);
        const size_t n = m->first[m->n_cloud];
        tile[k] = malloc((n + 1) * sizeof **tile);
        if (!tile[k])
            return error_memory(e, "the domain", n * sizeof **tile);
        if (r == me)
            memcpy(tile[k], m->mine, n * sizeof **tile);
        else
            receive[n_receive++] = (struct parcel){r, tile[k], n * sizeof **tile};
    }
    if (wire_begin(h->wire, h->parcel, n_send, receive, n_receive, e) || wire_finish(h->wire, e))
        return -1;
    return 0;
}

static void lay_rows(const struct making *m)
{
    const size_t n = m->first[m->n_cloud];
    for (size_t t = 0; t < n; t++) {
        struct tile *row = &m->row[t / ROW];
        if (t % ROW == 0)
            *row = m->tile[t];
        tile_join(row, &m->tile[t]);
    }
}

static int look(struct making *m, struct error *e)
{
    struct halo *h = m->h;
    struct tile **tile = calloc(h->n_peer + 1, sizeof *tile);
    int status = tile ? trade_tiles(m, tile, e) : error_memory(e, "the domain", h->n_peer);
    for (size_t k = 0; !status && k < h->n_peer; k++) {
        if (!tile[k])
            continue;
        m->tile = tile[k];
        lay_tiles(m, h->peer[k].rank, m->first);
        lay_rows(m);
        status = look_for_peer(m, &h->peer[k], e);
    }
    for (size_t k = 0; tile && !status && k < h->n_peer; k++)
        free(tile[k]);
    if (!status)
        free(tile);
    return status;
}

/* -- What comes of it -------- */

/* This rank's own images leave the peers. */
static int take_own(struct halo *h, struct ghosts *own, struct error *e)
{
    for (size_t a = 0; a < h->n_array; a++)
        own[a].n = 0;
    for (size_t k = 0; k < h->n_peer; k++) {
        struct halo_peer *q = &h->peer[k];
        if (q->rank != wire_rank(h->wire))
            continue;
        for (size_t a = 0; a < h->n_array; a++) {
            const struct halo_part *p = &q->part[a];
            if (ghosts_reserve(&own[a], p->n_send, e))
                return -1;
            own[a].n = p->n_send;
            if (p->n_send) {
                memcpy(own[a].parent, p->send, p->n_send * sizeof *p->send);
                memcpy(own[a].image, p->image, p->n_send);
            }
            free(p->send);
            free(p->image);
        }
        free(q->part);
        memmove(q, q + 1, (h->n_peer - k - 1) * sizeof *q);
        h->n_peer--;
        break;
    }
    return 0;
}

/* How many of each array come from whom. */
static int trade_counts(struct halo *h, struct error *e)
{
    const size_t n = h->n_array;
    uint64_t *count = malloc((2 * h->n_peer * n + 1) * sizeof *count);
    struct parcel *receive = h->parcel + h->n_peer;
    if (!count)
        return error_memory(e, "the domain", 2 * h->n_peer * n * sizeof *count);
    for (size_t k = 0; k < h->n_peer; k++) {
        uint64_t *mine = count + 2 * k * n;
        for (size_t a = 0; a < n; a++)
            mine[a] = h->peer[k].part[a].n_send;
        h->parcel[k] = (struct parcel){h->peer[k].rank, mine, n * sizeof *mine};
        receive[k] = (struct parcel){h->peer[k].rank, mine + n, n * sizeof *mine};
    }
    if (wire_begin(h->wire, h->parcel, h->n_peer, receive, h->n_peer, e) || wire_finish(h->wire, e))
        return -1;
    for (size_t k = 0; k < h->n_peer; k++)
        for (size_t a = 0; a < n; a++)
            h->peer[k].part[a].n_receive = count[(2 * k + 1) * n + a];
    free(count);
    return 0;
}

/* Where each peer's ghosts stand; room for their codes. */
static int lay_ghosts(struct halo *h, const struct ghosts *own, struct error *e)
{
    for (size_t a = 0; a < h->n_array; a++) {
        size_t n = own[a].n;
        for (size_t k = 0; k < h->n_peer; k++) {
            h->peer[k].part[a].first = n;
            n += h->peer[k].part[a].n_receive;
        }
        h->n_ghost[a] = n;
        if (n > UINT32_MAX / 2)
            return error_set(e, EXIT_RUN, "%zu ghosts on a rank: more than an array holds", n);
        if (n > h->image_capacity[a]) {
            uint8_t *image = realloc(h->image[a], n + n / 8);
            if (!image)
                return error_memory(e, "ghosts", n);
            h->image[a] = image;
            h->image_capacity[a] = n + n / 8;
        }
        if (own[a].n)
            memcpy(h->image[a], own[a].image, own[a].n);
    }
    return 0;
}

/* As which images they come: an array at a time. */
static int trade_codes(struct halo *h, struct error *e)
{
    struct parcel *receive = h->parcel + h->n_peer;
    for (size_t a = 0; a < h->n_array; a++) {
        for (size_t k = 0; k < h->n_peer; k++) {
            struct halo_part *p = &h->peer[k].part[a];
            h->parcel[k] = (struct parcel){h->peer[k].rank, p->image, p->n_send};
            receive[k] = (struct parcel){h->peer[k].rank, h->image[a] + p->first, p->n_receive};
        }
        if (wire_begin(h->wire, h->parcel, h->n_peer, receive, h->n_peer, e) ||
            wire_finish(h->wire, e))
            return -1;
    }
    return 0;
}

int halo_make(struct halo *h, const struct halo_job *job, struct ghosts *own, struct error *e)
{
    struct making m = {.h = h, .job = job, .n_cloud = job->n_frame * job->n_array};
    m.n_code = codes_of(job->box, m.code);
    m.first = calloc(2 * (m.n_cloud + 1), sizeof *m.first);
    m.first_block = m.first + m.n_cloud + 1;
    m.row = malloc((m.n_cloud * TILES / ROW + 1) * sizeof *m.row);
    int status = m.first && m.row ? 0 : error_memory(e, "the domain", m.n_cloud);
    if (!status)
        status = introduce(&m, e) || find_peers(&m, e) || look(&m, e) || take_own(h, own, e) ||
                         trade_counts(h, e) || lay_ghosts(h, own, e) || trade_codes(h, e)
                     ? -1
                     : 0;
    if (status)
        return -1; /* messages may still be under way: what they use is not given back */
    free(m.first);
    free(m.row);
    free(m.block);
    free(m.mine);
    free(m.whole);
    free(m.n_tile);
    return 0;
}
