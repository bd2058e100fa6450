# Libraries of plug-ins. No other target links them.

find_package(PkgConfig REQUIRED)
pkg_check_modules(CAIRO REQUIRED IMPORTED_TARGET cairo cairo-ft cairo-pdf)  # libcairo2-dev

# Videos of runs. Debian's FFmpeg is a GPL build (docs/figures.md); without it, `run --video` says so.
pkg_check_modules(FFMPEG IMPORTED_TARGET libavcodec libavformat libavutil libswscale)

# Without it, ranks (cluster/) are limited to a single process. Debian's VTK 9.1 also searches for it.
find_package(MPI QUIET COMPONENTS C)
find_package(VTK 9.1 REQUIRED COMPONENTS CommonCore CommonDataModel IOXML FiltersCore FiltersFlowPaths InteractionWidgets RenderingOpenGL2 RenderingFreeType)
find_package(X11 REQUIRED)

# OpenCV without its CMake package, which Debian provides only with all of OpenCV (libopencv-dev).
find_path(OPENCV_INCLUDE opencv2/aruco.hpp PATH_SUFFIXES opencv4 REQUIRED)  # libopencv-contrib-dev
set(OPENCV_LIBRARIES "")
foreach(part core imgproc imgcodecs videoio calib3d aruco)
  find_library(OPENCV_${part} opencv_${part} REQUIRED)
  list(APPEND OPENCV_LIBRARIES ${OPENCV_${part}})
endforeach()

# GDAL without its CMake package, which searches for everything that GDAL may be built with.
find_path(GDAL_INCLUDE gdal.h PATH_SUFFIXES gdal REQUIRED)  # libgdal-dev
find_library(GDAL gdal REQUIRED)

# tinygltf without its CMake package, which names a static library that Debian does not have.
find_path(TINYGLTF_INCLUDE tiny_gltf.h REQUIRED)  # libtinygltf-dev
find_library(TINYGLTF tinygltf REQUIRED)

# Assimp without its CMake package, which names a static zlib.
find_path(ASSIMP_INCLUDE assimp/scene.h REQUIRED)  # libassimp-dev
find_library(ASSIMP assimp REQUIRED)

# urdfdom without its CMake package, which searches for TinyXML (liburdfdom-dev).
find_path(URDFDOM_INCLUDE urdf_parser/urdf_parser.h REQUIRED)
find_library(URDFDOM urdfdom_model REQUIRED)
find_library(CONSOLE_BRIDGE console_bridge REQUIRED)

# Cyclone DDS without its CMake package, which requires OpenSSL's headers (cyclonedds-dev).
find_path(CYCLONEDDS_INCLUDE dds/dds.h REQUIRED)
find_library(CYCLONEDDS ddsc REQUIRED)

# Fast DDS (libfastrtps-dev). Without it, services do not answer clients of rmw_fastrtps, and the tests with a Fast DDS
# peer are omitted.
find_library(FASTDDS fastrtps)
find_library(FASTCDR fastcdr)
if(NOT FASTDDS OR NOT FASTCDR)
  message(STATUS "libfastrtps-dev is missing: no sensorfarm_fastdds, no ros2_tests")
endif()

# Links each plug-in whose target add_module() has created.
function(link_plugins)
  target_link_libraries(sensorfarm_cairo PRIVATE PkgConfig::CAIRO)
  target_link_libraries(sensorfarm_vtk PRIVATE VTK::IOXML VTK::FiltersCore VTK::FiltersFlowPaths VTK::InteractionWidgets VTK::RenderingOpenGL2 VTK::RenderingFreeType X11::X11)
  target_include_directories(sensorfarm_opencv SYSTEM PRIVATE ${OPENCV_INCLUDE})
  target_link_libraries(sensorfarm_opencv PRIVATE fmt::fmt ${OPENCV_LIBRARIES})
  target_include_directories(sensorfarm_pictures SYSTEM PRIVATE ${OPENCV_INCLUDE})
  target_link_libraries(sensorfarm_pictures PRIVATE fmt::fmt ${OPENCV_core} ${OPENCV_imgcodecs})
  add_dependencies(world sensorfarm_pictures)  # loaded by world/picture.cpp
  target_include_directories(sensorfarm_gdal SYSTEM PRIVATE ${GDAL_INCLUDE})
  target_link_libraries(sensorfarm_gdal PRIVATE fmt::fmt ${GDAL})
  target_include_directories(sensorfarm_gltf SYSTEM PRIVATE ${TINYGLTF_INCLUDE})
  target_sources(sensorfarm_gltf PRIVATE ${CMAKE_SOURCE_DIR}/base/elementary.cpp)
  target_link_libraries(sensorfarm_gltf PRIVATE fmt::fmt ${TINYGLTF})
  target_include_directories(sensorfarm_assimp SYSTEM PRIVATE ${ASSIMP_INCLUDE})
  target_link_libraries(sensorfarm_assimp PRIVATE fmt::fmt ${ASSIMP})
  target_include_directories(sensorfarm_urdf SYSTEM PRIVATE ${URDFDOM_INCLUDE})
  target_link_libraries(sensorfarm_urdf PRIVATE fmt::fmt ${URDFDOM} ${CONSOLE_BRIDGE})
  target_include_directories(sensorfarm_dds SYSTEM PRIVATE ${CYCLONEDDS_INCLUDE})
  target_compile_definitions(sensorfarm_dds PRIVATE DDS_NDEBUG)  # as in the library's build
  target_link_libraries(sensorfarm_dds PRIVATE fmt::fmt ${CYCLONEDDS})
  if(FFMPEG_FOUND)
    target_link_libraries(sensorfarm_ffmpeg PRIVATE PkgConfig::FFMPEG)
  endif()
  if(MPI_C_FOUND)
    target_link_libraries(sensorfarm_mpi PRIVATE MPI::MPI_C)
    target_compile_definitions(sensorfarm_mpi PRIVATE OMPI_SKIP_MPICXX MPICH_SKIP_MPICXX)
  endif()
endfunction()
