# sph-plugin.mk -- builds, checks, packs and installs a plugin of sph. For GNU make; sph-plugin.pc
# knows where it is. A plugin's Makefile names its files and includes it:
#
#   PLUGIN = my-thing
#   SOURCES = my-thing.c
#   include $(shell pkg-config --variable=makefile sph-plugin)
#
# Before the include may stand besides:
#   VERSION      in the name of the tarball that `make dist` packs; 0.1
#   HEADERS      headers and pair bodies, for the tarball
#   TESTS        programs or scripts that `make check` runs, see there
#   CHECK_FLAGS  for sph-plugin-check, as in --load kernels if the plugin needs another one
#   EXTRA_DIST   other files for the tarball; README* and LICENSE* are packed anyhow
#   LIBS         libraries that the plugin needs, as in -lfftw3
# The user's variables are CC, CXX, CPPFLAGS, CFLAGS, CXXFLAGS, LDFLAGS, DESTDIR, SPH and
# PKG_CONFIG, as anywhere. Sources end in .c, or in .cc, .cpp or .cxx. Objects go into build/.

.DEFAULT_GOAL := all
.SUFFIXES:
.DELETE_ON_ERROR:

PKG_CONFIG ?= pkg-config
VERSION ?= 0.1

ifeq ($(strip $(PLUGIN)),)
  $(error sph-plugin.mk: set PLUGIN, the name of the plugin, before the include)
endif
ifeq ($(strip $(SOURCES)),)
  $(error sph-plugin.mk: set SOURCES, the source files of $(PLUGIN), before the include)
endif

# -- The installation of sph ---------------------------------------------------------------------

sph_variable = $(shell $(PKG_CONFIG) --variable=$(1) sph-plugin)
sph_cppflags := $(shell $(PKG_CONFIG) --cflags sph-plugin)
sph_cflags := $(call sph_variable,plugin_cflags)
sph_cxxflags := $(call sph_variable,plugin_cxxflags)
sph_ldflags := $(call sph_variable,plugin_ldflags)
sph_libs := $(call sph_variable,plugin_libs)
sph_abi_major := $(call sph_variable,abi_major)
sph_bindir := $(abspath $(call sph_variable,bindir))
# abspath: the folders are relative to sph-plugin.pc's, whose .. DESTDIR would have to follow.
pluginsdir ?= $(abspath $(call sph_variable,pluginsdir))
userpluginsdir = $(or $(XDG_DATA_HOME),$(HOME)/.local/share)/sph/plugins-$(sph_abi_major)
SPH ?= $(sph_bindir)/sph
SPH_PLUGIN_CHECK ?= $(sph_bindir)/sph-plugin-check

# -- Build ---------------------------------------------------------------------------------------

sph_module := $(PLUGIN).so
sph_objects := $(patsubst %,build/%.o,$(SOURCES))
# A pair body is included by a header of the SDK, and for devices by the assembler, which gcc does not
# tell of -iquote.
sph_folders := $(patsubst %,-I%,$(sort $(dir $(SOURCES))))
sph_link := $(if $(filter %.cc %.cpp %.cxx,$(SOURCES)),$(CXX),$(CC))
CFLAGS ?= -g
CXXFLAGS ?= -g

.PHONY: all check dist distcheck install install-user uninstall uninstall-user clean help
all: $(sph_module)

# CFLAGS after ours: who sets them means them.
sph_preprocess = $(sph_cppflags) $(sph_folders) $(CPPFLAGS) -MMD -MP
sph_compile_c = $(CC) $(sph_preprocess) $(sph_cflags) $(CFLAGS)
sph_compile_cxx = $(CXX) $(sph_preprocess) $(sph_cxxflags) $(CXXFLAGS)
sph_link_module = $(sph_link) $(sph_ldflags) $(LDFLAGS)

$(sph_module): $(sph_objects)
	$(sph_link_module) -o $@ $(sph_objects) $(LIBS) $(sph_libs)
	@chmod go-w $@ # sph refuses what others may write to

build/%.c.o: %.c build/flags
	@mkdir -p $(@D)
	$(sph_compile_c) -c -o $@ $<
define sph_cxx_rule
build/%.$(1).o: %.$(1) build/flags
	@mkdir -p $$(@D)
	$$(sph_compile_cxx) -c -o $$@ $$<
endef
$(foreach suffix,cc cpp cxx,$(eval $(call sph_cxx_rule,$(suffix))))

# Changes when a compiler or a flag does, and then everything is made again; but what is installed is
# what was built, whatever the flags of who installs it.
.PHONY: sph-look
build/flags: $(if $(filter install%,$(MAKECMDGOALS)),,sph-look)
	@mkdir -p build
	@echo '$(subst ','\'',$(sph_compile_c) $(sph_compile_cxx) $(sph_link_module) $(LIBS))' \
	  >build/flags.now
	@cmp -s build/flags.now $@ && rm build/flags.now || mv build/flags.now $@

-include $(sph_objects:.o=.d)

# -- Check ---------------------------------------------------------------------------------------

# Each test runs in this folder and fails by its exit status (77: skipped). It finds the program in
# SPH, and a scene finds the plugin by its name: this folder is searched first.
check: all
	$(SPH_PLUGIN_CHECK) $(CHECK_FLAGS) ./$(sph_module)
	@SPH='$(SPH)' SPH_PLUGIN_PATH='$(CURDIR)'; export SPH SPH_PLUGIN_PATH; failed=0; \
	for test in $(TESTS); do \
	  case $$test in /*) ;; *) test=./$$test ;; esac; \
	  $$test; status=$$?; \
	  case $$status in \
	  0) echo "PASS: $$test" ;; \
	  77) echo "SKIP: $$test" ;; \
	  *) echo "FAIL: $$test (exit status $$status)"; failed=1 ;; \
	  esac; \
	done; exit $$failed

# -- Pack ----------------------------------------------------------------------------------------

sph_dist := $(PLUGIN)-$(VERSION)
sph_dist_files = $(sort $(firstword $(MAKEFILE_LIST)) $(SOURCES) $(HEADERS) $(TESTS) $(EXTRA_DIST) \
	$(wildcard README* LICENSE* COPYING* .gitignore))

dist: $(sph_dist).tar.gz
$(sph_dist).tar.gz: $(sph_dist_files)
	tar -czf $@ --transform 's,^,$(sph_dist)/,' --owner=0 --group=0 --numeric-owner \
	  $(sph_dist_files)

# Proof that the tarball has all that it needs.
distcheck: dist
	rm -rf build/distcheck && mkdir -p build/distcheck
	tar -xzf $(sph_dist).tar.gz -C build/distcheck
	$(MAKE) -C build/distcheck/$(sph_dist) check
	rm -rf build/distcheck

# -- Install -------------------------------------------------------------------------------------

install: all
	install -d '$(DESTDIR)$(pluginsdir)'
	install -m 644 $(sph_module) '$(DESTDIR)$(pluginsdir)'
uninstall:
	rm -f '$(DESTDIR)$(pluginsdir)/$(sph_module)'

# For this user alone: needs no rights.
install-user: all
	install -d '$(userpluginsdir)'
	install -m 644 $(sph_module) '$(userpluginsdir)'
uninstall-user:
	rm -f '$(userpluginsdir)/$(sph_module)'

# -- Tidy ----------------------------------------------------------------------------------------

clean:
	rm -rf build $(sph_module) $(sph_dist).tar.gz $(CLEANFILES)

help:
	@echo 'make                builds $(sph_module)'
	@echo 'make check          examines it with sph-plugin-check, then runs $(or $(TESTS),no tests)'
	@echo 'make install        into $(pluginsdir) (DESTDIR= in front)'
	@echo 'make install-user   into $(userpluginsdir)'
	@echo 'make uninstall, make uninstall-user   the reverse'
	@echo 'make dist           packs $(sph_dist).tar.gz; make distcheck proves it complete'
	@echo 'make clean          removes what was built'
