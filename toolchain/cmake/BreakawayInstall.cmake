# Install rules and the exported package: find_package(breakaway 0.1) gives the targets breakaway::<leaf>, under the names
# that the aliases have inside this tree, so that a consumer may switch between package and add_subdirectory at will.
include_guard(GLOBAL)
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

get_property(leaves GLOBAL PROPERTY BREAKAWAY_LEAVES)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/breakaway)

# What a static library uses privately is still needed to link it, so the consumer must find it as well. A foreign target is
# named after its package, as in fmt::fmt.
set(BREAKAWAY_DEPENDENCIES "")
foreach(leaf IN LISTS leaves)
  get_target_property(used ${leaf} INTERFACE_LINK_LIBRARIES)
  string(REGEX MATCHALL "[A-Za-z0-9_]+::" packages "${used}")
  list(APPEND BREAKAWAY_DEPENDENCIES ${packages})
  install(DIRECTORY $<TARGET_PROPERTY:${leaf},SOURCE_DIR>/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
          FILES_MATCHING PATTERN "*.hpp" PATTERN "*.h")
endforeach()
list(TRANSFORM BREAKAWAY_DEPENDENCIES REPLACE "::" "")
list(REMOVE_DUPLICATES BREAKAWAY_DEPENDENCIES)
list(REMOVE_ITEM BREAKAWAY_DEPENDENCIES breakaway)

install(TARGETS ${leaves} EXPORT breakawayTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
if(TARGET breakaway_law_shared)
  install(TARGETS breakaway_law_shared EXPORT breakawayTargets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  # For programs in C, whose build knows nothing of CMake.
  configure_file("${CMAKE_CURRENT_LIST_DIR}/breakaway_law.pc.in" "${PROJECT_BINARY_DIR}/breakaway_law.pc" @ONLY)
  install(FILES "${PROJECT_BINARY_DIR}/breakaway_law.pc" DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endif()
install(EXPORT breakawayTargets NAMESPACE breakaway:: DESTINATION ${package_folder})
get_property(programs GLOBAL PROPERTY BREAKAWAY_PROGRAMS)
if(programs)
  install(TARGETS ${programs} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
if(TARGET breakaway_cli)
  get_target_property(described breakaway_cli BREAKAWAY_DESCRIBED)
  install(FILES "${described}/breakaway.1" DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
  install(FILES "${described}/breakaway" DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
  install(FILES "${described}/breakaway.schema.json" DESTINATION ${CMAKE_INSTALL_DATADIR}/breakaway)
  install(FILES "${PROJECT_SOURCE_DIR}/sim/study/cluster/study.sbatch" DESTINATION ${CMAKE_INSTALL_DATADIR}/breakaway)
endif()
if(TARGET breakaway_node)
  # The unit names the program where it is installed, and `cmake --install --prefix` says that no earlier than now.
  set(unit "${PROJECT_SOURCE_DIR}/firmware/targets/linux/breakaway-node.service")
  set(installed_unit "${PROJECT_BINARY_DIR}/breakaway-node.service")
  install(CODE "file(READ \"${unit}\" text)
    string(REPLACE /usr/local/bin/ \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_BINDIR}/\" text \"\${text}\")
    file(WRITE \"${installed_unit}\" \"\${text}\")")
  install(FILES "${installed_unit}" DESTINATION lib/systemd/system)
endif()

configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/breakawayConfig.cmake.in"
  "${PROJECT_BINARY_DIR}/breakawayConfig.cmake" INSTALL_DESTINATION ${package_folder})
# Before 1.0 a minor version may break its users, so 0.2 does not stand in for 0.1.
write_basic_package_version_file("${PROJECT_BINARY_DIR}/breakawayConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/breakawayConfig.cmake" "${PROJECT_BINARY_DIR}/breakawayConfigVersion.cmake"
  DESTINATION ${package_folder})
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" "${PROJECT_SOURCE_DIR}/CHANGELOG.md" DESTINATION ${CMAKE_INSTALL_DOCDIR})
