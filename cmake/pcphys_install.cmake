# cmake --install, and the package that find_package(pcphys) loads.
if(NOT PCPHYS_INSTALL)
  return()
endif()
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/pcphys)

install(TARGETS pcphys EXPORT pcphys-targets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
  RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS pcphys_fcl EXPORT pcphys-fcl-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT pcphys-fcl-targets NAMESPACE pcphys:: DESTINATION ${package_dir})
install(DIRECTORY include/pcphys ${PCPHYS_GENERATED}/include/pcphys DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT pcphys-targets NAMESPACE pcphys:: DESTINATION ${package_dir})

configure_package_config_file(cmake/pcphys-config.cmake.in ${PROJECT_BINARY_DIR}/pcphys-config.cmake
  INSTALL_DESTINATION ${package_dir})
# Before 1.0 a minor version may break: 0.1.x serves a request for 0.1 only.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/pcphys-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/pcphys-config.cmake ${PROJECT_BINARY_DIR}/pcphys-config-version.cmake
  cmake/pcphys_kernel_flags.cmake DESTINATION ${package_dir})
if(TARGET pcphys_command)
  install(TARGETS pcphys_command RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
