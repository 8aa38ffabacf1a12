# Files that `cmake --install` copies, to the folders that Debian expects. The tree can be moved: the program finds share/clothbench relative
# to its own location (harness/base/data_folder), and so does the CMake package with the header.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(CMAKE_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(data ${CMAKE_INSTALL_DATADIR}/clothbench)
set(doc ${CMAKE_INSTALL_DATADIR}/doc/clothbench)
set(generated ${CMAKE_BINARY_DIR}/packaging)

install(TARGETS clothbench RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY scenarios DESTINATION ${data})
install(DIRECTORY results/baselines DESTINATION ${data}/results)
install(FILES results/paper-table3.json DESTINATION ${data}/results)
install(PROGRAMS scripts/fetch-assets.sh scripts/slurm_study.sh DESTINATION ${data}/scripts)
# The program contains both files, too. A build without Node, which bundles them, has neither.
install(FILES ${CMAKE_BINARY_DIR}/web/template.html ${CMAKE_BINARY_DIR}/web/figures.cjs DESTINATION ${data}/page OPTIONAL)
install(FILES scripts/assets-package.json scripts/assets-package-lock.json DESTINATION ${data}/scripts)

# For authors of plugins: find_package(clothbench), target_link_libraries(mine PRIVATE clothbench::plugin).
add_library(clothbench_plugin INTERFACE)
set_target_properties(clothbench_plugin PROPERTIES EXPORT_NAME plugin)
target_include_directories(clothbench_plugin INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
install(FILES harness/include/clothbench_plugin.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(TARGETS clothbench_plugin EXPORT clothbench)
set(package ${CMAKE_INSTALL_DATADIR}/cmake/clothbench)
install(EXPORT clothbench NAMESPACE clothbench:: FILE clothbenchConfig.cmake DESTINATION ${package})
write_basic_package_version_file(${generated}/clothbenchConfigVersion.cmake COMPATIBILITY SameMajorVersion ARCH_INDEPENDENT)
install(FILES ${generated}/clothbenchConfigVersion.cmake DESTINATION ${package})

# MTIME 0, because the time of the build would make the file differ from build to build.
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/CHANGELOG.md)
file(ARCHIVE_CREATE OUTPUT ${generated}/changelog.gz PATHS ${PROJECT_SOURCE_DIR}/CHANGELOG.md FORMAT raw
  COMPRESSION GZip COMPRESSION_LEVEL 9 MTIME 0)
install(FILES scripts/packaging/copyright ${generated}/changelog.gz DESTINATION ${doc})
install(FILES results/README.md DESTINATION ${doc} RENAME result-files.md)
install(FILES solvers/plugin/README.md DESTINATION ${doc} RENAME plugins.md)
install(DIRECTORY solvers/plugin/example/ DESTINATION ${doc}/examples/plugin)
install(DIRECTORY scripts/examples/ DESTINATION ${doc}/examples/results PATTERN __pycache__ EXCLUDE)
install(FILES scripts/ci/clothbench-check.yml DESTINATION ${doc}/examples/ci)
