# cmake -D SOURCE_DIR= -D OUTPUT= -P reference_code.cmake: the SHA-256 of all sources that a reference value depends on, as C++.
# A value cached from other sources is not found again, so no version number has to be raised by hand.
set(folders solvers/reference harness/base harness/truth harness/scenario harness/scenario/kinds harness/include/clothbench)
set(files harness/runner/reference.cpp harness/runner/reference.hpp harness/runner/frame_loop.cpp harness/runner/frame_loop.hpp
  harness/metrics/truth_errors.cpp harness/metrics/truth_errors.hpp)
set(watch "")
if(LIST_FILES)
  set(watch CONFIGURE_DEPENDS)
endif()
foreach(folder ${folders})
  file(GLOB found RELATIVE ${SOURCE_DIR} ${watch} ${SOURCE_DIR}/${folder}/*.cpp ${SOURCE_DIR}/${folder}/*.hpp)
  list(APPEND files ${found})
endforeach()
list(SORT files)
if(LIST_FILES)  # for the build, which waits for them
  list(TRANSFORM files PREPEND ${SOURCE_DIR}/)
  return()
endif()
set(all "")
foreach(file ${files})
  file(SHA256 ${SOURCE_DIR}/${file} hash)
  string(APPEND all "${file} ${hash}\n")
endforeach()
string(SHA256 CODE "${all}")
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[
#include "runner/reference.hpp"

namespace clothbench {
const char* const kReferenceCode = "@CODE@";
}  // namespace clothbench
]])
