find_program(GLSLC glslc REQUIRED)
find_program(SPIRV_VAL spirv-val REQUIRED)

# clothbench_add_spirv(<list> <name> <shader> DEPENDS <files>... [FLAGS <flags>...]): compiles and validates a shader; adds <name>.spv to <list>
function(clothbench_add_spirv list name shader)
  cmake_parse_arguments(S "" "" "DEPENDS;FLAGS" ${ARGN})
  set(out ${CMAKE_CURRENT_BINARY_DIR}/${name}.spv)
  add_custom_command(OUTPUT ${out}
    DEPENDS ${shader} ${S_DEPENDS}
    COMMAND ${GLSLC} --target-env=vulkan1.1 -O -Werror ${S_FLAGS} -o ${out} ${CMAKE_CURRENT_SOURCE_DIR}/${shader}
    COMMAND ${SPIRV_VAL} --target-env vulkan1.1 ${out}
    VERBATIM)
  set(${list} ${${list}} ${out} PARENT_SCOPE)
endfunction()

# clothbench_embed_spirv(<target> <files>...): a library of these files, and <target>.inc, which defines SPIRV: their names and code.
# The assembler embeds them, because a compiler needs seconds for literals of a megabyte.
function(clothbench_embed_spirv target)
  set(code ".section .rodata\n")
  set(table "#define SPIRV ")
  foreach(file ${ARGN})
    get_filename_component(name ${file} NAME_WE)
    string(APPEND code ".balign 4\n.globl ${name}_spirv, ${name}_end\n${name}_spirv: .incbin \"${file}\"\n${name}_end:\n")
    string(APPEND arrays "extern \"C\" const std::uint32_t ${name}_spirv[], ${name}_end[];\n")
    string(APPEND table "\\\n  {\"${name}\", {${name}_spirv, static_cast<std::size_t>(${name}_end - ${name}_spirv) * 4}},")
  endforeach()
  file(GENERATE OUTPUT ${target}.inc CONTENT "${arrays}${table}\n")
  file(GENERATE OUTPUT ${target}.S CONTENT "${code}.section .note.GNU-stack,\"\",%progbits\n")
  add_library(${target} STATIC ${CMAKE_CURRENT_BINARY_DIR}/${target}.S)
  set_source_files_properties(${CMAKE_CURRENT_BINARY_DIR}/${target}.S PROPERTIES OBJECT_DEPENDS "${ARGN}")
  target_include_directories(${target} INTERFACE ${CMAKE_CURRENT_BINARY_DIR})
endfunction()
