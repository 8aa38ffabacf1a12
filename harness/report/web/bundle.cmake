# Included by harness/report: makes template.cpp, the page without data, from src/ and the packages of package-lock.json.
# Run as a script (cmake -P) by the build: gets the packages, bundles; where that fails, writes a template.cpp that says
# why. Nothing in the packages is executed but esbuild.
if(NOT CMAKE_SCRIPT_MODE_FILE)
  set(web ${CMAKE_CURRENT_SOURCE_DIR}/web)
  set(template ${CMAKE_BINARY_DIR}/web/template.cpp)
  find_program(CLOTHBENCH_NODE NAMES node nodejs)
  find_program(CLOTHBENCH_NPM npm)
  file(GLOB sources CONFIGURE_DEPENDS ${web}/src/*)
  add_custom_command(OUTPUT ${template}
    COMMAND ${CMAKE_COMMAND} -DWEB=${web} -DWORK=${CMAKE_BINARY_DIR}/web -DNODE=${CLOTHBENCH_NODE} -DNPM=${CLOTHBENCH_NPM} -P ${web}/bundle.cmake
    DEPENDS ${sources} ${web}/bundle.cmake ${web}/bundle.mjs ${web}/package-lock.json
    COMMENT "Bundling the report's page" VERBATIM)
  target_sources(clothbench_report PRIVATE ${template})
  return()
endif()

function(give_up why)
  message(STATUS "The report's page is left out: ${why}. Once that is mended, delete ${WORK}/template.cpp and build again.")
  file(WRITE ${WORK}/template.cpp "#include \"report/web/page.hpp\"
namespace clothbench {
PageTemplate page_template() { return {\"\", \"${why} when this was built\"}; }
}  // namespace clothbench
")
endfunction()

if(NOT NODE OR NOT NPM)
  give_up("there was no Node with npm")
  return()
endif()

# Written last, so an interrupted fetch is started again.
set(fetched ${WORK}/fetched-lock.json)
execute_process(COMMAND ${CMAKE_COMMAND} -E compare_files ${WEB}/package-lock.json ${fetched} RESULT_VARIABLE differs ERROR_QUIET)
if(differs)
  file(REMOVE ${fetched})
  file(COPY ${WEB}/package.json ${WEB}/package-lock.json DESTINATION ${WORK})
  execute_process(COMMAND ${NPM} ci --engine-strict --ignore-scripts --no-audit --no-fund --fetch-retries=1 --fetch-timeout=60000
    WORKING_DIRECTORY ${WORK} TIMEOUT 420 RESULT_VARIABLE failed OUTPUT_FILE ${WORK}/npm.log ERROR_FILE ${WORK}/npm-errors.log)
  if(failed)
    give_up("npm ci failed (it needs Node 18 or later)")
    return()
  endif()
  file(COPY_FILE ${WEB}/package-lock.json ${fetched})
endif()
# Beside the packages, so that Node finds them.
file(COPY_FILE ${WEB}/bundle.mjs ${WORK}/bundle.mjs)
execute_process(COMMAND ${NODE} ${WORK}/bundle.mjs ${WEB}/src ${WORK} COMMAND_ERROR_IS_FATAL ANY)
