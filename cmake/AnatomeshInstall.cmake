# What `cmake --install` and CPack deliver: the program, two shared libraries, headers, CMake and pkg-config files.
#
# libanatomesh       the mesher and assess(); needs oneTBB only
# libanatomesh_io    image and mesh files; needs ITK and VTK
include(CMakePackageConfigHelpers)

# anatomesh_install_library(TARGET EXPORTED_NAME COMPONENT DESCRIPTION REQUIRES LIBRARIES)
# The library, its CMake targets in a file of their own, and its pkg-config file.
function(anatomesh_install_library target exported component description requires)
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${exported})
  install(TARGETS ${target} EXPORT ${target}_targets
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${component} NAMELINK_COMPONENT development)
  install(EXPORT ${target}_targets NAMESPACE anatomesh:: FILE anatomesh-${exported}-targets.cmake
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/anatomesh COMPONENT development)
  get_target_property(PC_LIBRARY ${target} OUTPUT_NAME)
  file(RELATIVE_PATH PC_PREFIX "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
  set(PC_DESCRIPTION "${description}")
  set(PC_REQUIRES "${requires}")
  configure_file("${PROJECT_SOURCE_DIR}/cmake/library.pc.in" "${PROJECT_BINARY_DIR}/${PC_LIBRARY}.pc" @ONLY)
  install(FILES "${PROJECT_BINARY_DIR}/${PC_LIBRARY}.pc" DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
    COMPONENT development)
endfunction()

anatomesh_install_library(anatomesh_mesher mesher mesher "Segmented medical images to tetrahedral meshes" "")
add_library(anatomesh::mesher ALIAS anatomesh_mesher)  # as for those who find the installed one
set(headers_left_out)
if(ANATOMESH_BUILD_IO)
  anatomesh_install_library(anatomesh_files io files "Image and mesh files of Anatomesh" "anatomesh")
else()
  set(headers_left_out PATTERN io.h EXCLUDE)
endif()

install(DIRECTORY "${PROJECT_SOURCE_DIR}/include/anatomesh" DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  COMPONENT development FILES_MATCHING PATTERN *.h ${headers_left_out})
configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/anatomesh-config.cmake.in"
  "${PROJECT_BINARY_DIR}/anatomesh-config.cmake" INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/anatomesh)
write_basic_package_version_file("${PROJECT_BINARY_DIR}/anatomesh-config-version.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/anatomesh-config.cmake" "${PROJECT_BINARY_DIR}/anatomesh-config-version.cmake"
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/anatomesh COMPONENT development)
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT mesher)

# Debian packages: `cpack -G DEB` in the build folder.
set(CPACK_PACKAGE_VENDOR "Anatomesh")
set(CPACK_PACKAGE_CONTACT "Anatomesh maintainers <maintainers@anatomesh.invalid>")
set(CPACK_RESOURCE_FILE_LICENSE "${PROJECT_SOURCE_DIR}/LICENSE")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${PROJECT_BINARY_DIR}/src" "${PROJECT_BINARY_DIR}/src/io")
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME anatomesh)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_MESHER_PACKAGE_NAME libanatomesh)
set(CPACK_DEBIAN_MESHER_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_FILES_PACKAGE_NAME libanatomesh-io)
set(CPACK_DEBIAN_FILES_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libanatomesh-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENTS_ALL mesher development)
set(CPACK_COMPONENT_MESHER_DESCRIPTION "Segmented medical images to tetrahedral meshes: the library")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "Anatomesh: headers, CMake and pkg-config files")
set(CPACK_COMPONENT_DEVELOPMENT_DEPENDS mesher)
if(ANATOMESH_BUILD_IO)
  list(APPEND CPACK_COMPONENTS_ALL files program)
  set(CPACK_COMPONENT_FILES_DESCRIPTION "Anatomesh: image and mesh files")
  set(CPACK_COMPONENT_FILES_DEPENDS mesher)
  set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "Segmented medical images to tetrahedral meshes: the program")
  list(APPEND CPACK_COMPONENT_DEVELOPMENT_DEPENDS files)
endif()
include(CPack)
