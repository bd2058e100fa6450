# What `cmake --install` puts in place: the program, its plug-ins, the public headers and library with a CMake package, the
# worlds, examples, and the GLSL that kernels of own sensors include. And a Debian package of all that (cpack in the build folder).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(SENSORFARM_DATA ${CMAKE_INSTALL_DATADIR}/sensorfarm)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/sensorfarm)

add_library(sensorfarm_headers INTERFACE)
target_include_directories(sensorfarm_headers INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_compile_features(sensorfarm_headers INTERFACE cxx_std_20)
set_target_properties(sensorfarm_headers PROPERTIES EXPORT_NAME headers)
target_link_libraries(sensorfarm_library INTERFACE sensorfarm_headers)

set_target_properties(sensorfarm_text_renderer sensorfarm_opencv PROPERTIES INSTALL_RPATH "")
install(TARGETS sensorfarm RUNTIME)
install(TARGETS sensorfarm_text_renderer sensorfarm_opencv LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/sensorfarm)
install(TARGETS sensorfarm_library sensorfarm_headers EXPORT sensorfarm LIBRARY NAMELINK_SKIP)
install(TARGETS sensorfarm_library LIBRARY NAMELINK_ONLY)
install(DIRECTORY sensorfarm TYPE INCLUDE FILES_MATCHING PATTERN "*.h")
install(DIRECTORY worlds experiments examples DESTINATION ${SENSORFARM_DATA} PATTERN __pycache__ EXCLUDE)
install(FILES shaders/lib/own_sensor.glsl DESTINATION ${SENSORFARM_DATA}/shaders/shaders/lib)
install(FILES sensors/own_sensor_records.h DESTINATION ${SENSORFARM_DATA}/shaders/sensors)
install(FILES ${CMAKE_BINARY_DIR}/generated/shaders/sensors/own_sensor_records.glsl DESTINATION ${SENSORFARM_DATA}/shaders/shaders/sensors)
install(FILES LICENSE README.md CHANGELOG.md TYPE DOC)

install(EXPORT sensorfarm NAMESPACE sensorfarm:: FILE sensorfarm-targets.cmake DESTINATION ${package})
configure_package_config_file(cmake/sensorfarm-config.cmake.in ${CMAKE_BINARY_DIR}/sensorfarm-config.cmake
                              INSTALL_DESTINATION ${package} PATH_VARS SENSORFARM_DATA)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/sensorfarm-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/sensorfarm-config.cmake ${CMAKE_BINARY_DIR}/sensorfarm-config-version.cmake DESTINATION ${package})

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME sensorfarm)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "2-D multi-robot simulator and virtual-sensor server")
set(CPACK_PACKAGE_CONTACT "the sensorfarm maintainers")
set(CPACK_PACKAGE_FILE_NAME sensorfarm_${PROJECT_VERSION}_${CMAKE_SYSTEM_PROCESSOR})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS mesa-vulkan-drivers)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_BINARY_DIR})
include(CPack)
