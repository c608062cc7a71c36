# SPH_MISSING(WHAT, DEBIAN-PACKAGE)
# ---------------------------------
# Stop, and name the package that a Debian system would install. ./bootstrap holds the list of
# packages; tests/packages.sh reads the second arguments here and compares the two.
AC_DEFUN([SPH_MISSING],
  [AC_MSG_ERROR([$1 was not found: install the package $2 (its name on Debian; ./bootstrap does it), or see config.log])])

# SPH_USE(CFLAGS, LIBS)
# ---------------------
# Add a library to what the core is built with. The headers of others are included as system
# headers: our warnings are for our own code.
AC_DEFUN([SPH_USE],
  [SPH_DEP_CFLAGS="$SPH_DEP_CFLAGS `AS_ECHO([" $1"]) | sed 's/ -I */ -isystem /g'`"
   SPH_DEP_LIBS="$SPH_DEP_LIBS $2"])

# SPH_NEED(VARIABLE-PREFIX, PKG-CONFIG-MODULE, WHAT, DEBIAN-PACKAGE)
# ------------------------------------------------------------------
# A library that pkg-config knows and that the core cannot do without.
AC_DEFUN([SPH_NEED],
  [PKG_CHECK_MODULES([$1], [$2], [], [SPH_MISSING([$3], [$4])])
   SPH_USE([$$1_CFLAGS], [$$1_LIBS])])

# SPH_NEED_LIB(HEADER, LIBRARY, FUNCTION, WHAT, DEBIAN-PACKAGE)
# -------------------------------------------------------------
# The same for a library without a pkg-config file.
AC_DEFUN([SPH_NEED_LIB],
  [sph_save_CPPFLAGS=$CPPFLAGS
   CPPFLAGS="$CPPFLAGS $SPH_DEP_CFLAGS"
   AC_CHECK_HEADER([$1], [], [SPH_MISSING([$4], [$5])])
   AC_CHECK_LIB([$2], [$3], [:], [SPH_MISSING([$4], [$5])], [$SPH_DEP_LIBS])
   CPPFLAGS=$sph_save_CPPFLAGS
   SPH_USE([], [-l$2])])

# SPH_CC_FLAGS(VARIABLE, FLAGS...)
# --------------------------------
# Append to VARIABLE each flag that the compiler takes without a complaint.
AC_DEFUN([SPH_CC_FLAGS],
  [m4_foreach_w([sph_flag], [$2],
    [AS_VAR_PUSHDEF([sph_cache], [sph_cv_cc_flag_]sph_flag)
     AC_CACHE_CHECK([whether $CC takes sph_flag], [sph_cache],
       [sph_save_CFLAGS=$CFLAGS
        CFLAGS="$CFLAGS -Werror sph_flag"
        AC_COMPILE_IFELSE([AC_LANG_PROGRAM([], [])],
          [AS_VAR_SET([sph_cache], [yes])], [AS_VAR_SET([sph_cache], [no])])
        CFLAGS=$sph_save_CFLAGS])
     AS_VAR_IF([sph_cache], [yes], [$1="$$1 sph_flag"])
     AS_VAR_POPDEF([sph_cache])])])
