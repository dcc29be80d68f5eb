# The Debian package of what BreakawayInstall installs: `cpack -G DEB` in a build tree, or toolchain/package.sh.
include_guard(GLOBAL)
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "the breakaway developers <breakaway@localhost>")
set(CPACK_PACKAGE_VENDOR breakaway)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_THREADS 0)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION "An axis with dry friction is let stick and then kicked free, so that it reaches its target under every friction inside
 stated bounds. The command designs, certifies and simulates an axis, and so does the Python module; the node runs it on drives on CAN
 (CANopen, CiA 402); library and headers are for firmware of one's own.")
# What the programs are linked with is asked of the binaries. Pictures are drawn by gnuplot, and the C++ libraries of the
# design are built against Eigen and {fmt}.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS gnuplot-nox)
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "g++, cmake, libeigen3-dev, libfmt-dev, libtomlplusplus-dev, can-utils, sdpa")
if(BREAKAWAY_BUILD_PYTHON)  # the module is of this Python only, and wants numpy
  math(EXPR next_minor "${BREAKAWAY_PYTHON_MINOR} + 1")
  string(APPEND CPACK_DEBIAN_PACKAGE_SUGGESTS
    ", python3 (>= 3.${BREAKAWAY_PYTHON_MINOR}~), python3 (<< 3.${next_minor}), python3-numpy")
endif()
# The loader's cache takes in libbreakaway_law.so.
file(WRITE "${PROJECT_BINARY_DIR}/triggers" "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA "${PROJECT_BINARY_DIR}/triggers")
include(CPack)
