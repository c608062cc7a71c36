# sph.m4 -- for the configure.ac of a plugin of sph.
#
# SPH_PLUGIN_INIT([ABI-VERSION])
# ------------------------------
# Finds the SDK of sph by pkg-config (add the folder of sph-plugin.pc to PKG_CONFIG_PATH if it is in
# none of the usual places) and stops with a sentence if it is not there, or if ABI-VERSION (as 0.2)
# is given and the SDK's ABI has another major version or an older minor one. To be called after
# AC_PROG_CC and LT_INIT. Substitutes
#
#   SPH_PLUGIN_CPPFLAGS  where the headers are
#   SPH_PLUGIN_CFLAGS    how plugins are compiled: optimisation, and every symbol hidden but one
#   SPH_PLUGIN_CXXFLAGS  the same for C++
#   SPH_PLUGIN_LDFLAGS   for libtool: a module with one exported symbol, all others resolved
#   SPH_PLUGIN_LIBS      libraries that any plugin may need
#   sph_pluginsdir       where sph looks for plugins; --with-sph-pluginsdir=DIR chooses another
#   SPH                  the program, for tests
#   SPH_PLUGIN_CHECK     sph-plugin-check, for tests
#
# and a Makefile.am needs no more than
#
#   sph_plugins_LTLIBRARIES = my-thing.la
#   my_thing_la_SOURCES = my-thing.c
#   my_thing_la_CPPFLAGS = $(SPH_PLUGIN_CPPFLAGS) -I$(srcdir)
#   my_thing_la_CFLAGS = $(SPH_PLUGIN_CFLAGS)
#   my_thing_la_LDFLAGS = -module $(SPH_PLUGIN_LDFLAGS)   # automake looks for -module itself
#   my_thing_la_LIBADD = $(SPH_PLUGIN_LIBS)
#
# serial 1
AC_DEFUN([SPH_PLUGIN_INIT],
  [AC_REQUIRE([PKG_PROG_PKG_CONFIG])
   AC_MSG_CHECKING([for the plugin SDK of sph])
   AS_IF([test -z "$PKG_CONFIG"], [AC_MSG_ERROR([pkg-config is not installed])])
   AS_IF([$PKG_CONFIG sph-plugin], [],
     [AC_MSG_RESULT([no])
      AC_MSG_ERROR([pkg-config finds no sph-plugin: is sph installed, and the folder of its sph-plugin.pc in PKG_CONFIG_PATH?])])
   sph_abi=`$PKG_CONFIG --variable=abi_version sph-plugin`
   AC_MSG_RESULT([yes, ABI $sph_abi])
   m4_ifval([$1],
     [AS_IF([test "${sph_abi%%.*}" != "m4_bpatsubst([$1], [\..*])" ||
             test "${sph_abi@%:@*.}" -lt "m4_bpatsubst([$1], [.*\.])"],
       [AC_MSG_ERROR([this plugin needs ABI $1 of sph; the SDK found has $sph_abi])])])
   SPH_PLUGIN_CPPFLAGS=`$PKG_CONFIG --cflags sph-plugin`
   SPH_PLUGIN_CFLAGS=`$PKG_CONFIG --variable=plugin_cflags sph-plugin`
   SPH_PLUGIN_CXXFLAGS=`$PKG_CONFIG --variable=plugin_cxxflags sph-plugin`
   SPH_PLUGIN_LDFLAGS="-module -avoid-version -shared -no-undefined -Wl,-z,defs -Wl,-z,now -export-symbols-regex '^sph_plugin_entry\$\$'"
   SPH_PLUGIN_LIBS=`$PKG_CONFIG --variable=plugin_libs sph-plugin`
   _SPH_PLUGIN_DIR([sph_bindir], [bindir])
   _SPH_PLUGIN_DIR([sph_pluginsdir], [pluginsdir])
   AC_ARG_WITH([sph-pluginsdir],
     [AS_HELP_STRING([--with-sph-pluginsdir=DIR], [install the plugin in DIR (default: where sph looks for plugins)])],
     [sph_pluginsdir=$withval])
   AC_ARG_VAR([SPH], [the program sph, for the tests])
   : ${SPH=$sph_bindir/sph}
   AC_ARG_VAR([SPH_PLUGIN_CHECK], [the program sph-plugin-check, for the tests])
   : ${SPH_PLUGIN_CHECK=$sph_bindir/sph-plugin-check}
   AC_SUBST([SPH_PLUGIN_CPPFLAGS])
   AC_SUBST([SPH_PLUGIN_CFLAGS])
   AC_SUBST([SPH_PLUGIN_CXXFLAGS])
   AC_SUBST([SPH_PLUGIN_LDFLAGS])
   AC_SUBST([SPH_PLUGIN_LIBS])
   AC_SUBST([sph_pluginsdir])])

# A folder of the installation without the .. that sph-plugin.pc has in it.
AC_DEFUN([_SPH_PLUGIN_DIR],
  [$1=`$PKG_CONFIG --variable=$2 sph-plugin | sed -e ':a' -e 's|/[[^/]][[^/]]*/\.\./|/|;ta'`])
