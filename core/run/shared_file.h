/* run/shared_file.h -- a file of results that all ranks write, or one alone: aside, and by rank 0 given its name when
 * all are done with it. All ranks make the same calls. */
#ifndef RUN_SHARED_FILE_H
#define RUN_SHARED_FILE_H

#include "io/output.h"
#include "run/run.h"

/* Where to write to, in fresh memory. When it succeeds all ranks are here: until the file is committed or dropped
 * whatever fails is agreed on (run_domain_agree) before anybody goes elsewhere. */
int shared_file_begin(struct run *r, const struct output *o, const char *name, char **temporary,
                      struct error *e);
/* status: of this rank, until now. If any is not 0 the file goes, and all fail. Frees the path. */
int shared_file_end(struct run *r, const struct output *o, char *temporary, const char *name,
                    int status, struct error *e);
/* A text that rank 0 has becomes that of all, in fresh memory; on one rank it stays as it is. */
int shared_text(const struct run *r, char **text, struct error *e);

#endif
