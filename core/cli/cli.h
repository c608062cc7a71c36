/* cli/cli.h -- the commands of sph. Each parses its own arguments (argp), prints its own errors
 * with cli_error, and returns the exit code (enum exit_code). argv[0] is "sph COMMAND". */
#ifndef CLI_CLI_H
#define CLI_CLI_H

#include "base/error.h"

int cli_run(int argc, char **argv);
int cli_info(int argc, char **argv);
int cli_plan(int argc, char **argv);
int cli_check(int argc, char **argv);
int cli_render(int argc, char **argv);
int cli_chart(int argc, char **argv);
int cli_new_plugin(int argc, char **argv);

/* Prints "sph: SENTENCE" on stderr; returns the error's exit code. */
int cli_error(const struct error *e);

#endif
