/* test_place.c -- where the folders of an installation are when its tree was moved. */
#include "config.h"

#include "base/place.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static void moved(const char *folder, const char *bindir, const char *here, const char *expected)
{
    char *found = place_moved(folder, bindir, here);

    if (expected) {
        assert_non_null(found);
        assert_string_equal(found, expected);
    } else {
        assert_null(found);
    }
    free(found);
}

static void test_moved(void **state)
{
    (void)state;
    moved("/usr/local/lib/sph/plugins-0", "/usr/local/bin", "/opt/bin", "/opt/lib/sph/plugins-0");
    moved("/usr/lib/x86_64-linux-gnu/sph/plugins-0", "/usr/bin", "/home/a/tree/bin",
          "/home/a/tree/lib/x86_64-linux-gnu/sph/plugins-0");
    moved("/usr/lib64/sph/plugins-0", "/usr/bin", "/usr/bin", "/usr/lib64/sph/plugins-0");
    moved("/usr/local/share/sph", "/usr/local/bin", "/tmp/stage/usr/local/bin",
          "/tmp/stage/usr/local/share/sph");
    /* At the root of the file system, before and after. */
    moved("/share/sph", "/bin", "/a/bin", "/a/share/sph");
    moved("/usr/share/sph", "/usr/bin", "/bin", "/share/sph");
    /* Programs in a deeper folder; heads of names that are equal, not names. */
    moved("/p/lib/sph", "/p/bin/deep", "/q/bin/deep", "/q/lib/sph");
    moved("/p/binary/sph", "/p/bin", "/q/bin", "/q/binary/sph");
    moved("/p/bin", "/p/bin", "/q/x", "/q/x");
    moved("/p/bin/sph", "/p/bin", "/q/x", "/q/x/sph");
    /* Nothing in common: all of it moves, or nothing. */
    moved("/data/sph", "/programs/bin", "/stage/programs/bin", "/stage/data/sph");
    moved("/data/sph", "/programs/bin", "/stage/bin", NULL);
}

static void test_elsewhere(void **state)
{
    (void)state;
    moved("/usr/local/lib/sph", "/usr/local/bin", "/home/a/build", NULL);
    moved("/usr/local/lib/sph", "/usr/local/bin", "/home/a/sbin", NULL);
    moved("/usr/local/lib/sph", "/usr/local/bin", "", NULL);
}

/* The program that asks lies in the build: it is told what configure was. */
static void test_not_moved(void **state)
{
    char *data = place_data(), *plugins = place_plugins(), *none = place_of("/no/such/folder");

    (void)state;
    assert_string_equal(data, SPH_DATADIR);
    assert_string_equal(plugins, SPH_PLUGINDIR);
    assert_string_equal(none, "/no/such/folder");
    free(data);
    free(plugins);
    free(none);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_moved),
        cmocka_unit_test(test_elsewhere),
        cmocka_unit_test(test_not_moved),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
