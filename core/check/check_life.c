/* check/check_life.c -- the check `life`: create and destroy in every dimension, twice and then
 * often, with nothing left behind. */
#include "check/checks.h"

#include "registry/fpmode.h"

#include <malloc.h>

/* So many uses, in so many rounds. What is lost each time grows in every round by no less than
 * malloc's smallest piece; what the C library keeps for itself does not. */
#define CYCLES 64
#define ROUNDS 4
#define SMALLEST 24

/* Of a build with the leak sanitizer, which replaces malloc and counts for itself. */
extern int __lsan_do_recoverable_leak_check(void) __attribute__((weak));

/* Bytes in use, where the C library tells. */
static size_t held(void)
{
#if defined(__GLIBC__) && (__GLIBC__ > 2 || __GLIBC_MINOR__ >= 33)
    const struct mallinfo2 m = mallinfo2();

    return m.uordblks + m.hblkhd;
#else
    return 0;
#endif
}

static int one_life(const struct subject *s, int dim, struct error *e)
{
    struct use use;
    int status;

    if (subject_configure(s, &use, e))
        return -1;
    stage(s, "create in %d dimensions", dim);
    status = use_create(&use, s->registry, dim, e);
    stage(s, "destroy in %d dimensions", dim);
    use_fini(&use, s->registry);
    return status;
}

/* False if something was said. */
static bool live(const struct subject *s, int dim)
{
    const uint64_t mode = fpmode_get();
    struct error e = {0};
    size_t least = SIZE_MAX;

    for (int i = 0; i < 2; i++)
        if (one_life(s, dim, &e)) {
            say(s, VERDICT_FAIL, "create in %d dimensions: %s", dim, e.text);
            return false;
        }
    if (fpmode_get() != mode) {
        say(s, VERDICT_FAIL, "create or destroy changes the floating point mode");
        return false;
    }
    for (int round = 0; round < ROUNDS; round++) {
        const size_t before = held();
        for (int i = 0; i < CYCLES; i++)
            if (one_life(s, dim, &e)) {
                say(s, VERDICT_FAIL, "create in %d dimensions, once more: %s", dim, e.text);
                return false;
            }
        if (held() <= before)
            least = 0;
        else if (held() - before < least)
            least = held() - before;
    }
    if (least >= CYCLES * SMALLEST) {
        say(s, VERDICT_FAIL, "create and destroy leave %zu bytes behind each time", least / CYCLES);
        return false;
    }
    if (__lsan_do_recoverable_leak_check && __lsan_do_recoverable_leak_check()) {
        say(s, VERDICT_FAIL, "create and destroy leave memory behind");
        return false;
    }
    return true;
}

void check_life(const struct subject *s)
{
    const sph_life *life = entry_life(s->entry);
    struct use use;
    struct error e = {0};
    char dims[40];

    if (subject_configure(s, &use, &e)) {
        say(s, VERDICT_NOTE, "is not called: %s", e.text);
        return;
    }
    use_fini(&use, s->registry);
    if (!life || !life->create)
        return;
    for (int dim = 1; dim <= 3; dim++)
        if (subject_works_in(s, dim) && !live(s, dim))
            return;
    say(s, VERDICT_OK, "created and destroyed %d times in %s, nothing left behind",
        2 + CYCLES * ROUNDS, subject_dims(s, dims, sizeof(dims)));
}
