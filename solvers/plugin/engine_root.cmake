# Shared by the adapters of engines that lie outside this tree.

# clothbench_engine_root(<VARIABLE> <file>...): stops configuring unless the folder that the variable names holds the files.
function(clothbench_engine_root variable)
  if(NOT ${variable})
    message(FATAL_ERROR "${variable} is not set: name the folder of the engine's checkout, -D${variable}=/path")
  endif()
  foreach(file ${ARGN})
    if(NOT EXISTS "${${variable}}/${file}")
      message(FATAL_ERROR "${variable}=${${variable}}: expected the file ${${variable}}/${file}, and it is not there")
    endif()
  endforeach()
endfunction()

# clothbench_plugin_header(<target>): in clothbench's own tree its own header counts, whatever is installed.
function(clothbench_plugin_header target)
  find_path(CLOTHBENCH_INCLUDE clothbench_plugin.h PATHS ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/../../harness/include NO_DEFAULT_PATH
    DOC "Where clothbench_plugin.h is, if not installed")
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_FUNCTION_LIST_DIR})
  if(CLOTHBENCH_INCLUDE)
    target_include_directories(${target} PRIVATE ${CLOTHBENCH_INCLUDE})
  else()
    find_package(clothbench REQUIRED)
    target_link_libraries(${target} PRIVATE clothbench::plugin)
  endif()
endfunction()
