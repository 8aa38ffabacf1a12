# Included by harness/report: makes template.cpp, the page without data, from src/ and the packages of package-lock.json.
# Nothing in the packages is executed but esbuild.
set(web ${CMAKE_CURRENT_SOURCE_DIR}/web)
set(template ${CMAKE_BINARY_DIR}/web/template.cpp)
find_program(CLOTHBENCH_NODE NAMES node nodejs)
find_program(CLOTHBENCH_NPM npm)
if(NOT CLOTHBENCH_NODE OR NOT CLOTHBENCH_NPM)
  message(STATUS "The report's page is left out: there is no Node with npm")
  return()
endif()
file(GLOB sources CONFIGURE_DEPENDS ${web}/src/*)
add_custom_command(OUTPUT ${template}
  COMMAND ${CLOTHBENCH_NODE} ${web}/bundle.mjs ${web} ${CMAKE_BINARY_DIR}/web ${CLOTHBENCH_NPM}
  DEPENDS ${sources} ${web}/bundle.mjs ${web}/package-lock.json
  COMMENT "Bundling the report's page" VERBATIM)
target_sources(clothbench_report PRIVATE web/motions.cpp ${template})
target_compile_definitions(clothbench_report PRIVATE CLOTHBENCH_WITH_PAGE)
