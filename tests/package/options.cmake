# cmake -DSOURCE=... -DBUILD=... -DGENERATOR=... "-DOPTIONS=..." "-DHAS=..." "-DLACKS=..." -P: configures the tree with OPTIONS and
# fails unless it has the targets HAS and none of LACKS. Lists are separated by spaces.
foreach(list IN ITEMS OPTIONS HAS LACKS)
  separate_arguments(${list})
endforeach()
file(REMOVE_RECURSE "${BUILD}")
execute_process(COMMAND ${CMAKE_COMMAND} -S "${SOURCE}" -B "${BUILD}" -G "${GENERATOR}" ${OPTIONS}
  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build "${BUILD}" --target help OUTPUT_VARIABLE targets COMMAND_ERROR_IS_FATAL ANY)
foreach(target IN LISTS HAS)
  if(NOT targets MATCHES "[ \n]${target}[:\n]")
    message(SEND_ERROR "no target ${target} with ${OPTIONS}")
  endif()
endforeach()
foreach(target IN LISTS LACKS)
  if(targets MATCHES "[ \n]${target}[:\n]")
    message(SEND_ERROR "a target ${target} with ${OPTIONS}")
  endif()
endforeach()
