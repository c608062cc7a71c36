/* domain/migrate.h -- particles that go to live on another rank, with all that they carry. */
#ifndef DOMAIN_MIGRATE_H
#define DOMAIN_MIGRATE_H

#include "domain/wire.h"
#include "particles/particles.h"

/* owner[i]: the rank that real particle i is to live on. Those that stay keep their order; behind them come
 * those of rank 0, 1, ..., each in the order in which they stood there. `state` columns come along; the others
 * hold nothing afterwards. Ghosts are lost. *sent: how many have left. All ranks call it, with arrays of the same
 * columns, held alike. */
int migrate(struct wire *w, struct particles *p, const int *owner, size_t *sent, struct error *e);

#endif
