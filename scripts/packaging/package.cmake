# `cpack -G DEB` and `cpack -G TGZ` in the build folder. For the .deb, install dpkg-dev and file, which determine its dependencies.
set(CLOTHBENCH_MAINTAINER "The clothbench authors <clothbench@clothbench.invalid>" CACHE STRING "Maintainer named in the packages")
set(CPACK_GENERATOR DEB TGZ)
set(CPACK_PACKAGE_NAME clothbench)
set(CPACK_PACKAGE_VENDOR "The clothbench authors")
set(CPACK_PACKAGE_CONTACT ${CLOTHBENCH_MAINTAINER})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "benchmark of real-time cloth solvers")
set(CPACK_PACKAGE_DESCRIPTION "clothbench runs interchangeable cloth solvers through the same scenes and writes down error, run time,
stability, penetration, frames per second and bandwidth, in one HDF5 file a run.
It comes with solvers on Vulkan and on the CPU, takes others as shared libraries,
and makes tables, figures and an interactive page of the results.")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS ${CMAKE_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS})

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
# SHLIBDEPS finds the linked libraries; the packages below are loaded or called at run time. Half of the solvers need a Vulkan driver.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "mesa-vulkan-drivers | vulkan-icd")
# For a report's figures, and for Python scripts that read results.
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "nodejs, librsvg2-bin, python3-matplotlib, python3-h5py")
# For movies, scanned rooms and hands, headsets, plugins, studies on a cluster, and views of results.
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "ffmpeg, npm, libopenxr-loader1, cmake, slurm-client, paraview")
include(CPack)
