# clothbench_add_spirv(<list> <name> <shader> DEPENDS <files>... [FLAGS <flags>...])
# Compiles and validates a shader, and adds <name>.inc (its 32-bit words as C literals, to be included in an array) to <list>.
# Also run as a script by the build: cmake -DSPIRV=<in> -DINC=<out> -P spirv.cmake
if(CMAKE_SCRIPT_MODE_FILE)
  file(READ ${SPIRV} words HEX)
  string(REGEX REPLACE "(..)(..)(..)(..)" "0x\\4\\3\\2\\1," words "${words}")
  # 16 words of 11 characters per line, because some editors and compilers fail on a line of a megabyte.
  string(REPEAT "..........." 16 line)
  string(REGEX REPLACE "(${line})" "\\1\n" words "${words}")
  file(WRITE ${INC} "${words}\n")
  return()
endif()

find_program(GLSLC glslc REQUIRED)
find_program(SPIRV_VAL spirv-val REQUIRED)
set(clothbench_spirv_script ${CMAKE_CURRENT_LIST_FILE})

function(clothbench_add_spirv list name shader)
  cmake_parse_arguments(S "" "" "DEPENDS;FLAGS" ${ARGN})
  set(out ${CMAKE_CURRENT_BINARY_DIR}/${name})
  add_custom_command(OUTPUT ${out}.inc
    DEPENDS ${shader} ${S_DEPENDS} ${clothbench_spirv_script}
    COMMAND ${GLSLC} --target-env=vulkan1.1 -O -Werror ${S_FLAGS} -o ${out}.spv ${CMAKE_CURRENT_SOURCE_DIR}/${shader}
    COMMAND ${SPIRV_VAL} --target-env vulkan1.1 ${out}.spv
    COMMAND ${CMAKE_COMMAND} -DSPIRV=${out}.spv -DINC=${out}.inc -P ${clothbench_spirv_script}
    VERBATIM)
  set(${list} ${${list}} ${out}.inc PARENT_SCOPE)
endfunction()
