/* base/error.h -- how the core reports: one sentence and an exit code, passed upwards by the caller's
 * struct. No function of the core prints an error or exits; main does. */
#ifndef BASE_ERROR_H
#define BASE_ERROR_H

enum exit_code {
    EXIT_DONE = 0,   /* */
    EXIT_RUN = 1,    /* the run failed; a last good state is kept */
    EXIT_USAGE = 2,  /* the command line or the scene is wrong */
    EXIT_REFUSED = 3 /* a plugin is refused */
};

struct error {
    int exit_code; /* enum exit_code */
    char text[1024];
};

/* Sets the sentence (printf-like; cut at a character boundary if too long) and returns -1, so that
 * `return error_set(e, EXIT_USAGE, ...)` is the way to fail. e may be NULL. */
int error_set(struct error *e, enum exit_code code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Puts "prefix: " in front of the sentence, if there is one; returns -1. */
int error_prefix(struct error *e, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* For a failed allocation of `bytes` for `what`. */
int error_memory(struct error *e, const char *what, unsigned long long bytes);

#endif
