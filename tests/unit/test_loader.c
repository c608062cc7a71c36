/* test_loader.c -- finding and loading plugin files: the search, and every refusal, each by one
 * sentence, after which the program goes on. The modules are those of tests/abi; each test works on
 * copies in a folder of its own. */
#include "config.h"

#include "registry/fpmode.h"
#include "registry/loader.h"

#include <dirent.h>
#include <elf.h>
#include <ftw.h>
#include <link.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

static char folder[] = "/tmp/sph-loader-XXXXXX";
static struct registry registry;
static struct error e;

/* Paths in the folder; a few may be in use at a time. */
static const char *path(const char *name)
{
    static char text[4][256];
    static int next;

    next = (next + 1) % 4;
    snprintf(text[next], sizeof(text[next]), "%s/%s", folder, name);
    return text[next];
}

static char *slurp(const char *file, size_t *n)
{
    FILE *f = fopen(file, "rb");
    char *data;
    long size;

    if (!f)
        fail_msg("cannot open %s", file);
    fseek(f, 0, SEEK_END);
    size = ftell(f);
    rewind(f);
    data = malloc((size_t)size + 1);
    assert_non_null(data);
    *n = fread(data, 1, (size_t)size, f);
    assert_int_equal(*n, size);
    fclose(f);
    return data;
}

static void write_file(const char *name, const void *data, size_t n)
{
    FILE *f = fopen(path(name), "wb");

    assert_non_null(f);
    assert_int_equal(fwrite(data, 1, n, f), n);
    assert_int_equal(fclose(f), 0);
    assert_int_equal(chmod(path(name), 0644), 0);
}

static char *module_bytes(const char *module, size_t *n)
{
    const char *modules = getenv("SPH_TEST_MODULES");
    const char *build = getenv("top_builddir");
    char file[4096];

    if (modules)
        snprintf(file, sizeof(file), "%s/%s.so", modules, module);
    else
        snprintf(file, sizeof(file), "%s/tests/abi/.libs/%s.so", build ? build : ".", module);
    return slurp(file, n);
}

static void copy_module(const char *module, const char *name)
{
    size_t n;
    char *data = module_bytes(module, &n);

    write_file(name, data, n);
    free(data);
}

static int remove_one(const char *name, const struct stat *st, int type, struct FTW *where)
{
    (void)st;
    (void)type;
    (void)where;
    return remove(name);
}

static int setup(void **state)
{
    (void)state;
    strcpy(folder + strlen(folder) - 6, "XXXXXX");
    if (!mkdtemp(folder))
        return -1;
    setenv("SPH_PLUGIN_PATH", folder, 1);
    setenv("XDG_DATA_HOME", folder, 1);
    e = (struct error){0};
    return registry_init(&registry, &e);
}

static int teardown(void **state)
{
    (void)state;
    registry_fini(&registry);
    chmod(folder, 0755);
    return nftw(folder, remove_one, 8, FTW_DEPTH | FTW_PHYS);
}

/* Is anything of a file of the folder mapped? */
static bool is_mapped(void)
{
    FILE *f = fopen("/proc/self/maps", "r");
    char line[4096];
    bool found = false;

    assert_non_null(f);
    while (fgets(line, sizeof(line), f))
        found = found || strstr(line, folder);
    fclose(f);
    return found;
}

static int open_files(void)
{
    DIR *d = opendir("/proc/self/fd");
    int n = 0;

    assert_non_null(d);
    while (readdir(d))
        n++;
    closedir(d);
    return n;
}

/* Loads; it must be refused with this in its sentence, and leave no trace. */
static void refused(const char *name, const char *says)
{
    const size_t plugins = registry.n_plugin;
    const size_t entries = registry.n_entry;
    const uint64_t mode = fpmode_get();
    const int files = open_files();

    e = (struct error){0};
    assert_int_not_equal(loader_load(&registry, name, &e), 0);
    if (!strstr(e.text, says))
        fail_msg("%s, not %s", e.text, says);
    assert_int_equal(e.exit_code, EXIT_REFUSED);
    assert_null(strchr(e.text, '\n'));
    assert_int_equal(registry.n_plugin, plugins);
    assert_int_equal(registry.n_entry, entries);
    assert_true(fpmode_get() == mode);
    assert_int_equal(open_files(), files);
    if (plugins == 0)
        assert_false(is_mapped());
}

static void taken(const char *name)
{
    e = (struct error){0};
    if (loader_load(&registry, name, &e))
        fail_msg("%s", e.text);
}

/* A module of tests/abi, refused under its path. */
static void module_refused(const char *module, const char *says)
{
    char name[64];

    snprintf(name, sizeof(name), "%s.so", module);
    copy_module(module, name);
    refused(path(name), says);
    assert_non_null(strstr(e.text, path(name)));
}

static void good_one_by_path_and_by_name(void **state)
{
    (void)state;
    copy_module("good", "good.so");
    taken("good");
    assert_int_equal(registry.n_plugin, 1);
    assert_true(is_mapped());
    assert_true(loader_descriptor(&registry.plugin[0]) >= 0);
    assert_string_equal(registry.plugin[0].path, path("good.so"));
    assert_string_equal(registry.plugin[0].name, "good");
    assert_string_equal(registry.plugin[0].version, "1.2");
    assert_non_null(registry_find(&registry, KIND_FUNCTION, "idle"));
    /* However it is called, it is loaded once. */
    assert_int_equal(symlink(path("good.so"), path("alias.so")), 0);
    taken("good.so");
    taken(path("good.so"));
    taken(path("alias.so"));
    taken("alias");
    assert_int_equal(registry.n_plugin, 1);
}

static void broken_at_the_border(void **state)
{
    char text[200];

    (void)state;
    module_refused("no_entry", "it has no function sph_plugin_entry");
    module_refused("null_entry", "its sph_plugin_entry returns NULL");
    module_refused("wrong_magic", "magic number 0x12345678");
    snprintf(text, sizeof(text), "it was built for the plugin ABI %u.0, but this sph has %u.%u",
             SPH_ABI_MAJOR + 1, SPH_ABI_MAJOR, SPH_ABI_MINOR);
    module_refused("other_major", text);
    snprintf(text, sizeof(text), "it was built for the plugin ABI %u.%u, but this sph has %u.%u",
             SPH_ABI_MAJOR, SPH_ABI_MINOR + 1, SPH_ABI_MAJOR, SPH_ABI_MINOR);
    module_refused("newer_minor", text);
    module_refused("small_struct", "size of the plugin's descriptor is 16 bytes");
    module_refused("huge_struct", "size of the plugin's descriptor is 2147483647 bytes");
}

static void broken_behind_it(void **state)
{
    (void)state;
    module_refused("failing_init", "its init failed: the moon is not full");
    module_refused("contradiction",
                   "function \"at-odds\": reach is 0, neither gather nor symmetric");
    copy_module("good", "good.so");
    taken(path("good.so"));
    module_refused("duplicate", "function \"idle\" is registered already, by ");
    assert_non_null(strstr(e.text, path("good.so")));
    copy_module("good", "better.so");
    refused(path("better.so"), "its name, \"good\", is that of a plugin loaded already, ");
    assert_non_null(strstr(e.text, path("good.so")));
}

static void undefined_symbol_is_named(void **state)
{
    (void)state;
    module_refused("undefined_symbol", "it cannot be linked: ");
    assert_non_null(strstr(e.text, "undefined symbol: nobody_has_this_function"));
}

static void floating_point_mode_is_guarded(void **state)
{
    (void)state;
#if defined(__SSE2__)
    volatile double tiny = 1e-310;
    volatile long double third = 1;
    module_refused("flush_to_zero", "changes the floating point mode");
    assert_true(tiny / 2 > 0);
    module_refused("fp_entry", "its sph_plugin_entry changes the floating point mode");
    module_refused("fp_init", "its init changes the floating point mode");
    third /= 3;
    assert_true(third != (long double)(float)third);
#else
    skip();
#endif
}

static void no_plugin_at_all(void **state)
{
    (void)state;
    write_file("text.so", "#!/bin/sh\necho hello\n", 21);
    refused(path("text.so"), "it is not an ELF file");
    write_file("empty.so", "", 0);
    refused(path("empty.so"), "it is empty");
    assert_int_equal(mkdir(path("folder.so"), 0755), 0);
    refused(path("folder.so"), "it is not a regular file");
    assert_int_equal(mkfifo(path("fifo.so"), 0644), 0);
    refused(path("fifo.so"), "it is not a regular file");
    refused(path("missing.so"), "No such file");
    e = (struct error){0};
    assert_int_not_equal(loader_load(&registry, "", &e), 0);
    assert_int_equal(e.exit_code, EXIT_USAGE);
}

static void symbolic_links(void **state)
{
    (void)state;
    assert_int_equal(symlink(path("b.so"), path("a.so")), 0);
    assert_int_equal(symlink(path("a.so"), path("b.so")), 0);
    refused(path("a.so"), "Too many levels of symbolic links");
    refused("a", "Too many levels of symbolic links");
    assert_int_equal(symlink(path("nowhere"), path("dangling.so")), 0);
    refused("dangling", "No such file");
}

static void who_may_write(void **state)
{
    (void)state;
    copy_module("good", "good.so");
    assert_int_equal(chmod(path("good.so"), 0666), 0);
    refused("good", "others may write to the file (mode 666");
    if (geteuid() == 0) { /* who else could give a file away? */
        assert_int_equal(chown(path("good.so"), 0, 12345), 0);
        assert_int_equal(chmod(path("good.so"), 0664), 0);
        refused("good", "others may write to the file (mode 664");
        assert_int_equal(chown(path("good.so"), 12345, 0), 0);
        assert_int_equal(chmod(path("good.so"), 0644), 0);
        refused("good", "the file belongs to user 12345");
        assert_int_equal(chown(path("good.so"), 0, 0), 0);
    }
    assert_int_equal(chmod(path("good.so"), 0644), 0);
    assert_int_equal(chmod(folder, 0777), 0);
    refused("good", "others may write to its folder ");
    assert_non_null(strstr(e.text, "(mode 777; chmod go-w)"));
    assert_int_equal(chmod(folder, 01777), 0);
    taken("good");
    assert_int_equal(chmod(folder, 0755), 0);
}

/* Every folder counts, on the way of a link as on that of its target. */
static void who_may_write_above(void **state)
{
    (void)state;
    assert_int_equal(mkdir(path("above"), 0755), 0);
    assert_int_equal(mkdir(path("above/below"), 0755), 0);
    copy_module("good", "above/below/good.so");
    assert_int_equal(symlink("above/below/good.so", path("link.so")), 0);
    assert_int_equal(symlink("../above/./below/good.so", path("above/link.so")), 0);
    assert_int_equal(chmod(path("above"), 0777), 0);
    refused(path("above/below/good.so"), "/above (mode 777");
    refused(path("above/below/../below/good.so"), "/above (mode 777");
    refused(path("link.so"), "/above (mode 777");
    refused(path("above/link.so"), "/above (mode 777");
    assert_int_equal(chmod(path("above"), 0755), 0);
    taken(path("above/link.so"));
    assert_string_equal(registry.plugin[0].path, path("above/below/good.so"));
    refused(path("link.so/x.so"), "Not a directory");
}

static void wild_pointers_are_refused(void **state)
{
    (void)state;
    module_refused("wild_pointer", "pointer to the item is 0x7f00dead0000, where nothing is");
    module_refused("unknown_kind", "its init failed: kind \"sph.telepathy/0\" is unknown");
}

/* A good module with a few bytes of its header changed. */
static void patched(const char *name, size_t at, const void *bytes, size_t n)
{
    size_t size;
    char *data = module_bytes("good", &size);

    memcpy(data + at, bytes, n);
    write_file(name, data, size);
    free(data);
}

static void other_machines(void **state)
{
    const uint16_t machine = EM_SPARC, executable = ET_EXEC;
    const unsigned char other = sizeof(void *) == 8 ? ELFCLASS32 : ELFCLASS64, order = 3;

    (void)state;
    patched("sparc.so", offsetof(ElfW(Ehdr), e_machine), &machine, sizeof(machine));
    refused("sparc", "it was built for ");
    patched("narrow.so", EI_CLASS, &other, 1);
    refused("narrow", "-bit machines, this sph for");
    patched("order.so", EI_DATA, &order, 1);
    refused("order", "another byte order");
    patched("program.so", offsetof(ElfW(Ehdr), e_type), &executable, sizeof(executable));
    refused("program", "it is not a shared object");
}

static void truncated_ones(void **state)
{
    size_t n;
    char *data = module_bytes("good", &n);

    (void)state;
    for (size_t k = 0; k < 200; k++) {
        const size_t cut = k < 100 ? k * 3 : n - 1 - (k - 100) * (n / 101);
        write_file("cut.so", data, cut);
        refused(path("cut.so"), cut == 0 ? "empty" : cut < 4 ? "not an ELF" : "truncated");
    }
    free(data);
}

static void what_is_not_found(void **state)
{
    (void)state;
    copy_module("good", "good.so");
    write_file("README", "no plugin", 9);
    refused("god", "no plugin \"god\" in ");
    assert_non_null(strstr(e.text, folder));
    assert_non_null(strstr(e.text, "(did you mean \"good\"?)"));
    refused("README", "no plugin \"README\"");
    setenv("SPH_PLUGIN_PATH", "::", 1);
    refused("good", "SPH_PLUGIN_PATH=:: switches the search off");
    taken(path("good.so"));
}

static void folders_in_order(void **state)
{
    char **list;
    size_t n;
    char both[600];

    (void)state;
    snprintf(both, sizeof(both), "/first::%s/second:", folder);
    setenv("SPH_PLUGIN_PATH", both, 1);
    list = loader_folders(&n);
    assert_int_equal(n, 4);
    assert_string_equal(list[0], "/first");
    assert_string_equal(list[1], path("second"));
    assert_string_equal(list[2], path("sph/plugins-0"));
    loader_folders_free(list, n);
    setenv("SPH_PLUGIN_PATH", "::", 1);
    list = loader_folders(&n);
    assert_int_equal(n, 0);
    loader_folders_free(list, n);
    unsetenv("SPH_PLUGIN_PATH");
    list = loader_folders(&n);
    assert_int_equal(n, 2);
    loader_folders_free(list, n);
}

static void users_folder(void **state)
{
    (void)state;
    unsetenv("SPH_PLUGIN_PATH");
    assert_int_equal(mkdir(path("sph"), 0755), 0);
    assert_int_equal(mkdir(path("sph/plugins-0"), 0755), 0);
    copy_module("good", "sph/plugins-0/good.so");
    setenv("SPH_PLUGIN_PATH", "::", 1);
    refused("good", "SPH_PLUGIN_PATH=:: switches the search off");
    setenv("SPH_PLUGIN_PATH", ":", 1); /* empty parts are none: the other folders stay */
    taken("good");
}

static void count(const char *sentence, void *context)
{
    if (!strstr(sentence, folder)) /* what is installed already is not this test's */
        return;
    assert_non_null(strstr(sentence, "text.so"));
    ++*(int *)context;
}

static void all_of_them(void **state)
{
    char both[600];
    int refusals = 0;
    size_t ours = 0;

    (void)state;
    assert_int_equal(mkdir(path("later"), 0755), 0);
    copy_module("good", "good.so");
    copy_module("contradiction", "later/good.so"); /* shadowed: not even looked at */
    write_file("text.so", "text", 4);
    write_file("README", "text", 4);
    snprintf(both, sizeof(both), "%s:%s:/nowhere", folder, path("later"));
    setenv("SPH_PLUGIN_PATH", both, 1);
    assert_int_equal(loader_load_all(&registry, count, &refusals, &e), 0);
    assert_int_equal(refusals, 1);
    for (size_t i = 0; i < registry.n_plugin; i++)
        ours += strncmp(registry.plugin[i].path, folder, strlen(folder)) == 0;
    assert_int_equal(ours, 1);
    assert_string_equal(registry.plugin[0].path, path("good.so"));
}

int main(void)
{
#define LOADER_TEST(f) cmocka_unit_test_setup_teardown(f, setup, teardown)
    const struct CMUnitTest tests[] = {
        LOADER_TEST(good_one_by_path_and_by_name),
        LOADER_TEST(broken_at_the_border),
        LOADER_TEST(broken_behind_it),
        LOADER_TEST(undefined_symbol_is_named),
        LOADER_TEST(floating_point_mode_is_guarded),
        LOADER_TEST(no_plugin_at_all),
        LOADER_TEST(symbolic_links),
        LOADER_TEST(who_may_write),
        LOADER_TEST(who_may_write_above),
        LOADER_TEST(wild_pointers_are_refused),
        LOADER_TEST(other_machines),
        LOADER_TEST(truncated_ones),
        LOADER_TEST(what_is_not_found),
        LOADER_TEST(folders_in_order),
        LOADER_TEST(users_folder),
        LOADER_TEST(all_of_them),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
