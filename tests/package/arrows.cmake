# The arrows between the rooms (arrows.txt), guarded at three places: what sources include, what targets link, and what is in the
# product when it is linked.
find_package(Python3 REQUIRED COMPONENTS Interpreter)
set(arrows ${Python3_EXECUTABLE} -B "${CMAKE_CURRENT_SOURCE_DIR}/arrows.py")
add_test(NAME arrows.no_file_includes_against_an_arrow COMMAND ${arrows} includes "${PROJECT_SOURCE_DIR}")
add_test(NAME arrows.every_arrow_back_is_noticed COMMAND ${arrows} selftest)

get_property(leaves GLOBAL PROPERTY BREAKAWAY_LEAVES)
set(links "")
foreach(leaf IN LISTS leaves)
  get_target_property(used ${leaf} INTERFACE_LINK_LIBRARIES)
  string(REGEX MATCHALL "breakaway::[a-z0-9_]+" used "${used}")
  list(JOIN used " " used)
  string(APPEND links "${leaf} ${used}\n")
endforeach()
string(REGEX REPLACE "breakaway(_|::)" "" links "${links}")
file(WRITE "${CMAKE_CURRENT_BINARY_DIR}/links.txt" "${links}")
add_test(NAME arrows.no_target_links_against_an_arrow COMMAND ${arrows} links "${CMAKE_CURRENT_BINARY_DIR}/links.txt")

# A user of a leaf does not even find the files of a room that it may not use.
function(forbidden_include room other)
  public_headers(breakaway_${other} headers)
  list(GET headers 0 header)
  set(name arrows.${room}_including_${other}_does_not_compile)
  package_compile_test(${name} breakaway_${room} package "#include <${header}>\n")
  set_tests_properties(${name} PROPERTIES PASS_REGULAR_EXPRESSION "${header}'?:? (No such file|file not found)")
endfunction()
forbidden_include(law hal)
forbidden_include(cia402 law)

# The simulator is not inside the product: no symbol of a friction law, a plant, an emulated drive or a virtual bus.
if(TARGET breakaway_node AND CMAKE_NM)
  add_test(NAME arrows.no_simulator_in_breakaway_node
    COMMAND ${CMAKE_COMMAND} -DNM=${CMAKE_NM} -DPROGRAM=$<TARGET_FILE:breakaway_node> -P "${CMAKE_CURRENT_SOURCE_DIR}/simulator_symbols.cmake")
endif()
