# Included when the build is for another machine: where its packages come from.
#
# Header-only packages are the build machine's own, linked one by one into a folder, because its whole include folder
# would bring in the wrong C library. Compiled ones belong to the target: Vulkan to the NDK or to CMAKE_FIND_ROOT_PATH,
# Bullet to CMAKE_FIND_ROOT_PATH. HDF5 and Google Benchmark are not used on a device.
set(CLOTHBENCH_HEADERS /usr/include CACHE PATH "Where the header-only packages lie (CLI, boost, eigen3, fmt, nlohmann, openxr, spirv, valijson, tiny_gltf.h, tiny_obj_loader.h)")
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

set(staged ${CMAKE_BINARY_DIR}/headers)
file(MAKE_DIRECTORY ${staged})
function(clothbench_header_link name)
  foreach(folder ${CLOTHBENCH_HEADERS} ${PROJECT_SOURCE_DIR}/build/valijson/usr/include)
    if(EXISTS ${folder}/${name})
      file(CREATE_LINK ${folder}/${name} ${staged}/${name} SYMBOLIC)
      return()
    endif()
  endforeach()
  message(FATAL_ERROR "CLOTHBENCH_HEADERS=${CLOTHBENCH_HEADERS}: no ${name} (Debian: scripts/bootstrap.sh)")
endfunction()
# clothbench_header_package(<package> <target> <folder to link> <include path below that folder> [definitions])
function(clothbench_header_package package target folder include)
  clothbench_header_link(${folder})
  # Every later find_package(<package>) finds this file first.
  file(WRITE ${CMAKE_FIND_PACKAGE_REDIRECTS_DIR}/${package}Config.cmake "
if(NOT TARGET ${target})
  add_library(${target} INTERFACE IMPORTED)
  set_target_properties(${target} PROPERTIES INTERFACE_INCLUDE_DIRECTORIES \"${staged}/${include}\"
    INTERFACE_COMPILE_DEFINITIONS \"${ARGN}\")
endif()
set(${package}_FOUND TRUE)
")
  # The build machine's own set-up sees to versions.
  file(WRITE ${CMAKE_FIND_PACKAGE_REDIRECTS_DIR}/${package}ConfigVersion.cmake "set(PACKAGE_VERSION_COMPATIBLE TRUE)\n")
endfunction()
clothbench_header_package(nlohmann_json nlohmann_json::nlohmann_json nlohmann .)
# Compiled where the target has it: its code in every source costs a third of the compile time.
find_library(CLOTHBENCH_FMT_LIBRARY fmt)
if(CLOTHBENCH_FMT_LIBRARY)
  clothbench_header_package(fmt fmt::fmt fmt .)
  file(APPEND ${CMAKE_FIND_PACKAGE_REDIRECTS_DIR}/fmtConfig.cmake
    "set_target_properties(fmt::fmt PROPERTIES INTERFACE_LINK_LIBRARIES ${CLOTHBENCH_FMT_LIBRARY})\n")
else()
  clothbench_header_package(fmt fmt::fmt fmt . FMT_HEADER_ONLY=1)
endif()
clothbench_header_package(CLI11 CLI11::CLI11 CLI .)
clothbench_header_package(valijson valijson valijson . VALIJSON_USE_EXCEPTIONS=1)
clothbench_header_package(Eigen3 Eigen3::Eigen eigen3 eigen3)
clothbench_header_package(Boost Boost::headers boost .)
clothbench_header_package(SPIRV-Headers SPIRV-Headers::SPIRV-Headers spirv .)
clothbench_header_link(tiny_gltf.h)
clothbench_header_link(tiny_obj_loader.h)
set(CLOTHBENCH_TINYOBJ_INCLUDE ${staged} CACHE PATH "" FORCE)
set(CLOTHBENCH_TINYGLTF_INCLUDE ${staged} CACHE PATH "" FORCE)
# Only a live session needs them; without them it is left out.
if(EXISTS ${CLOTHBENCH_HEADERS}/openxr/openxr_platform.h)
  clothbench_header_link(openxr)
  set(CLOTHBENCH_OPENXR_INCLUDE ${staged} CACHE PATH "" FORCE)
endif()
