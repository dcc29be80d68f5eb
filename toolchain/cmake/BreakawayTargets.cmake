# Every leaf of the tree is one target breakaway_<name> with the alias breakaway::<name>, and sees only the include folders
# of the leaves that it names: an include which the design forbids does not compile.
include_guard(GLOBAL)

# breakaway_cold(<target>): what runs once a command is optimised less, because there the compiler's time is the longer one.
function(breakaway_cold target)
  target_compile_options(${target} PRIVATE $<$<AND:$<CONFIG:Release>,$<CXX_COMPILER_ID:GNU,Clang>>:-O1>)
endfunction()

# breakaway_leaf(<name> [SOURCES file...] [USES breakaway::leaf...] [PRIVATE_USES target...] [FLASHED] [COLD])
# FLASHED: may end up on a motion controller, so neither exceptions nor RTTI, and no silent promotion to double.
# COLD: reads and writes files once a command; see breakaway_cold.
function(breakaway_leaf name)
  cmake_parse_arguments(PARSE_ARGV 1 LEAF "FLASHED;COLD" "" "SOURCES;USES;PRIVATE_USES")
  set(target breakaway_${name})
  if(LEAF_SOURCES)
    add_library(${target} STATIC ${LEAF_SOURCES})
    set(scope PUBLIC)
    target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:breakaway_developer_warnings>)
    if(LEAF_PRIVATE_USES)
      target_link_libraries(${target} PRIVATE ${LEAF_PRIVATE_USES})
    endif()
    if(LEAF_COLD)
      breakaway_cold(${target})
    endif()
    if(LEAF_FLASHED)
      target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU,Clang>:-fno-exceptions -fno-rtti -Wdouble-promotion>)
    endif()
  else()
    add_library(${target} INTERFACE)
    set(scope INTERFACE)
  endif()
  add_library(breakaway::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} CXX_EXTENSIONS OFF
    BREAKAWAY_FLASHED ${LEAF_FLASHED})
  target_compile_features(${target} ${scope} cxx_std_20)
  # -ffp-contract=off: a compiler that may fuse a*b+c on one machine and not on the next gives results that differ in the
  # last bit; the same object code must give the same bits in simulation and on target.
  # -fno-math-errno: nobody reads errno, and without it std::sqrt is one instruction and no call into the library.
  target_compile_options(${target} ${scope} $<$<CXX_COMPILER_ID:GNU,Clang>:-ffp-contract=off$<SEMICOLON>-fno-math-errno>)
  target_include_directories(${target} ${scope}
    $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
    $<INSTALL_INTERFACE:include>)
  target_link_libraries(${target} ${scope} ${LEAF_USES})
  set_property(GLOBAL APPEND PROPERTY BREAKAWAY_LEAVES ${target})
endfunction()

# breakaway_program(<target> <file name>): rules for an executable that is installed. It knows its version, which stands in
# project() and nowhere else, as BREAKAWAY_VERSION.
function(breakaway_program target file_name)
  set_target_properties(${target} PROPERTIES OUTPUT_NAME ${file_name} CXX_EXTENSIONS OFF)
  target_compile_definitions(${target} PRIVATE BREAKAWAY_VERSION="${PROJECT_VERSION}")
  set_property(GLOBAL APPEND PROPERTY BREAKAWAY_PROGRAMS ${target})
endfunction()

# Warnings are for developers; consumers of the package do not inherit them.
add_library(breakaway_developer_warnings INTERFACE)
option(BREAKAWAY_DEVELOPER_WARNINGS "Compile with the project's warnings as errors" OFF)
if(BREAKAWAY_DEVELOPER_WARNINGS)
  target_compile_options(breakaway_developer_warnings INTERFACE
    -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wold-style-cast -Wnon-virtual-dtor -Wcast-align
    -Wnull-dereference -Werror)
  # g++ collects its garbage less often: a tenth less of its time for a fifth more of its memory, of which a file takes 1 GB.
  target_compile_options(breakaway_developer_warnings INTERFACE
    $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=1000000>)
  if(NOT CMAKE_UNITY_BUILD)  # where one file's names are not another's
    target_compile_options(breakaway_developer_warnings INTERFACE -Wshadow)
  endif()
endif()

# breakaway_test(<name> SOURCES file... USES target... [LABELS label])
# A GoogleTest executable whose cases are found and registered with CTest one by one, or as a whole where only the tests of
# input are built. The label `slow` keeps it out of the runs under the sanitizers. One label only: gtest_discover_tests cannot
# pass on a list. Tests are breakaway_cold, as what computes is in the libraries, unless their folder sets
# BREAKAWAY_TESTS_COMPUTE.
function(breakaway_test name)
  cmake_parse_arguments(PARSE_ARGV 1 TEST "" "LABELS" "SOURCES;USES")
  if(TEST_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "breakaway_test(${name}): does not understand '${TEST_UNPARSED_ARGUMENTS}'")
  endif()
  add_executable(${name} ${TEST_SOURCES})
  target_link_libraries(${name} PRIVATE ${TEST_USES} GTest::gtest_main breakaway_developer_warnings)
  set_target_properties(${name} PROPERTIES CXX_EXTENSIONS OFF)
  set(precompiled breakaway_precompiled_to_compute)
  if(NOT BREAKAWAY_TESTS_COMPUTE)
    breakaway_cold(${name})
    # At -O1 g++ 12 loses sight of what std::string and Eigen hold, and warns of it.
    target_compile_options(${name} PRIVATE $<$<AND:$<CONFIG:Release>,$<CXX_COMPILER_ID:GNU>>:-Wno-array-bounds
      -Wno-maybe-uninitialized -Wno-stringop-overflow>)
    set(precompiled breakaway_precompiled)
  endif()
  # What is precompiled holds for the same rules of arithmetic only, which a test has from the leaves that it uses.
  if(TARGET ${precompiled} AND TEST_USES MATCHES "breakaway::")
    target_precompile_headers(${name} REUSE_FROM ${precompiled})
  endif()
  target_compile_definitions(${name} PRIVATE BREAKAWAY_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  set(labels "")
  if(TEST_LABELS)
    set(labels LABELS ${TEST_LABELS})
  endif()
  if(BREAKAWAY_TESTS_OF_INPUT_ONLY)
    # Under the sanitizers a program takes longer to start than most of its cases take.
    add_test(NAME ${name} COMMAND ${name} --gtest_brief=1)
    set_tests_properties(${name} PROPERTIES TIMEOUT 1800 ${labels})
  else()
    gtest_discover_tests(${name} PROPERTIES TIMEOUT 1800 ${labels} DISCOVERY_TIMEOUT 60)
  endif()
endfunction()
