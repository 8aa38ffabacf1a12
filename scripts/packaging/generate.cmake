# cmake -D PROGRAM= -D CHANGELOG= -D OUT= -P generate.cmake: completions, made by the program, and the changelog.
function(made_by_program file)
  execute_process(COMMAND ${PROGRAM} ${ARGN} OUTPUT_FILE ${OUT}/${file} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

# A time of its own would make the file differ from build to build.
function(compressed from to)
  file(ARCHIVE_CREATE OUTPUT ${OUT}/${to} PATHS ${from} FORMAT raw COMPRESSION GZip COMPRESSION_LEVEL 9 MTIME 0)
endfunction()

file(MAKE_DIRECTORY ${OUT})
foreach(shell bash zsh fish)
  made_by_program(clothbench.${shell} completion ${shell})
endforeach()
compressed(${CHANGELOG} changelog.gz)
