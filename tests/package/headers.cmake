# Every public header compiles alone: one test a header, which includes it twice in an otherwise empty file and sees the
# include folders of its own leaf only, under the rules that hold for what is flashed.

# package_compile_test(<name> <leaf target> <labels> <code> [argument...]): checks the syntax of `code` as a user of the leaf.
# Eigen's own headers do not compile without warnings, so where they are within reach they are a system's.
find_package(Eigen3 3.4 REQUIRED)
get_target_property(eigen_folder Eigen3::Eigen INTERFACE_INCLUDE_DIRECTORIES)
function(package_compile_test name leaf labels code)
  set(file "${CMAKE_CURRENT_BINARY_DIR}/sources/${name}.cpp")
  file(CONFIGURE OUTPUT "${file}" CONTENT "${code}" @ONLY)
  set(folders $<TARGET_PROPERTY:${leaf},INTERFACE_INCLUDE_DIRECTORIES>)
  add_test(NAME ${name} COMMAND_EXPAND_LISTS
    COMMAND ${CMAKE_CXX_COMPILER} -std=c++20 -fsyntax-only -Wall -Wextra -Wpedantic -Wconversion -Werror ${ARGN}
            "-I$<JOIN:${folders},;-I>" "$<$<IN_LIST:${eigen_folder},${folders}>:-isystem;${eigen_folder}>" "${file}")
  set_tests_properties(${name} PROPERTIES LABELS "${labels}" TIMEOUT 600)
endfunction()

# The public headers of a leaf as they are included.
function(public_headers leaf result)
  get_target_property(source_folder ${leaf} SOURCE_DIR)
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS RELATIVE "${source_folder}/include" "${source_folder}/include/*.hpp")
  set(${result} "${headers}" PARENT_SCOPE)
endfunction()

# All headers of what is flashed are compiled. The others take seconds each: every twelfth is, and the rest labelled `long`.
get_property(leaves GLOBAL PROPERTY BREAKAWAY_LEAVES)
set(counted 0)
foreach(leaf IN LISTS leaves)
  get_target_property(flashed ${leaf} BREAKAWAY_FLASHED)
  set(rules "")
  if(flashed)
    set(rules -fno-exceptions -fno-rtti -Wdouble-promotion)
  endif()
  public_headers(${leaf} headers)
  foreach(header IN LISTS headers)
    string(REGEX REPLACE "^breakaway/|[.]hpp$" "" title "${header}")
    string(REPLACE "/" "." title "${title}")
    set(labels package)
    math(EXPR counted "(${counted} + 1) % 12")
    if(NOT flashed AND NOT counted EQUAL 0)
      list(APPEND labels long)
    endif()
    package_compile_test(header.${title}.compiles_alone ${leaf} "${labels}" "#include <${header}>\n#include <${header}>\n" ${rules})
  endforeach()
endforeach()
