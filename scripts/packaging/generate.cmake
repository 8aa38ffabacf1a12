# cmake -D PROGRAM= -D CHANGELOG= -D OUT= -P generate.cmake: manual page and completions, made by the program.
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
made_by_program(clothbench.1 manual)
compressed(${OUT}/clothbench.1 clothbench.1.gz)
compressed(${CHANGELOG} changelog.gz)
