# cmake -DREADME=... -DSOURCE=... -P: fails unless the README holds the lines between the [README] marks of SOURCE, or all of a
# SOURCE that has no marks.
file(READ "${SOURCE}" source)
file(READ "${README}" readme)
if(source MATCHES "// \\[README\\]\n(.*)  // \\[README\\]")
  string(REGEX REPLACE "\n  " "\n" snippet "\n${CMAKE_MATCH_1}")
  string(STRIP "${snippet}" snippet)
else()
  set(snippet "\n${source}```\n")
endif()
string(FIND "${readme}" "${snippet}" place)
if(snippet STREQUAL "" OR place EQUAL -1)
  message(FATAL_ERROR "README.md does not show the snippet of ${SOURCE}:\n${snippet}")
endif()
