/* test_info.c -- what a name on the command line of `sph info` means, and which version is later. */
#include "config.h"

#include "cli/info.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static void test_versions(void **state)
{
    (void)state;
    assert_true(info_at_least("0.10", "0.9"));
    assert_false(info_at_least("0.9", "0.10"));
    assert_true(info_at_least("1", "1.0.0"));
    assert_true(info_at_least("1.0", "1"));
    assert_true(info_at_least("1.02", "1.2"));
    assert_false(info_at_least("1.2", "1.2.1"));
    assert_true(info_at_least("1.2.1", "1.2"));
    assert_true(info_at_least("2", "1.99.99"));
    assert_true(info_at_least("100000000000000000000000000001", "100000000000000000000000000000"));
    assert_false(info_at_least("99999999999999999999999999999", "100000000000000000000000000000"));
    /* What is no number ends a plugin's version. */
    assert_true(info_at_least("1.2-rc1", "1.2"));
    assert_false(info_at_least("1.2-rc1", "1.2.1"));
    assert_true(info_at_least("1.2rc.9", "1.2"));
    assert_false(info_at_least("1.2rc.9", "1.2.9"));
    assert_true(info_at_least("git", "0"));
    assert_false(info_at_least("git", "0.1"));
}

static void test_is_version(void **state)
{
    static const char *const good[] = {"0", "1.2", "00.10.3"};
    static const char *const bad[] = {"", ".", "1.", ".1", "1..2", "1a", "-1", " 1", "1 ", "+1"};

    (void)state;
    for (size_t i = 0; i < sizeof(good) / sizeof(good[0]); i++)
        assert_true(info_is_version(good[i]));
    for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++)
        assert_false(info_is_version(bad[i]));
}

static void test_plugin_names(void **state)
{
    struct plugin p = {.path = (char *)"/a/b/file.so", .name = (char *)"name"};

    (void)state;
    assert_true(info_names_plugin(&p, "name"));
    assert_true(info_names_plugin(&p, "plugin/name"));
    assert_true(info_names_plugin(&p, "file.so"));
    assert_true(info_names_plugin(&p, "./file.so"));
    assert_true(info_names_plugin(&p, "/elsewhere/plugin/file.so"));
    assert_false(info_names_plugin(&p, "file"));
    assert_false(info_names_plugin(&p, "plugin/file"));
    assert_false(info_names_plugin(&p, "plugin/file.so"));
    assert_false(info_names_plugin(&p, "scheme/name"));
    assert_false(info_names_plugin(&p, ""));
}

static void test_entry_names(void **state)
{
    const sph_item item = {.name = "name"};
    const struct entry x = {.kind = KIND_EOS, .item = &item};

    (void)state;
    assert_true(info_names_entry(&x, "name"));
    assert_true(info_names_entry(&x, "eos/name"));
    assert_false(info_names_entry(&x, "kernel/name"));
    assert_false(info_names_entry(&x, "eos/"));
    assert_false(info_names_entry(&x, "eosname"));
    assert_false(info_is_path("name"));
    assert_false(info_is_path("eos/name"));
    assert_true(info_is_path("./name"));
    assert_true(info_is_path("eos/name/more"));
    assert_true(info_is_path("other/name"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_versions),
        cmocka_unit_test(test_is_version),
        cmocka_unit_test(test_plugin_names),
        cmocka_unit_test(test_entry_names),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
