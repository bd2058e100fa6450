# A room is a folder, a namespace, a target and a folder of tests.

find_package(fmt REQUIRED)
find_package(Threads REQUIRED)
find_package(Vulkan REQUIRED)
find_package(ZLIB REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(nlohmann_json REQUIRED)
find_path(TOMLPLUSPLUS toml++/toml.h REQUIRED)  # headers only (libtomlplusplus-dev)

# Debian's VTK 9.1 asks for MPI while it is being found; nothing of ours uses it.
find_package(MPI QUIET COMPONENTS C)
find_package(VTK 9.1 REQUIRED COMPONENTS CommonCore CommonDataModel IOImage RenderingFreeType)

# Flags every target of ours is built with. Contraction is off so that host and device round alike; g++ 12 warns of
# overlapping strings (-Wrestrict) and, once headers are precompiled, of their bounds (-Warray-bounds) where nothing is wrong.
add_library(house INTERFACE)
target_include_directories(house INTERFACE ${CMAKE_SOURCE_DIR})
target_compile_options(house INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wno-missing-field-initializers -Wno-restrict -Wno-array-bounds -ffp-contract=off
                       $<$<BOOL:${SENSORFARM_WERROR}>:-Werror>)
if(SENSORFARM_SANITIZE)
  target_compile_options(house INTERFACE -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  target_link_options(house INTERFACE -fsanitize=address,undefined)
  target_sources(house INTERFACE ${CMAKE_SOURCE_DIR}/tests/keep_loaded.cpp)
endif()

# Standard headers that most sources include are compiled once: a third of the build's time. Sources still name what they
# use; -DSENSORFARM_PCH=OFF proves it.
option(SENSORFARM_PCH "Precompile the headers that most sources include" ON)
set(SENSORFARM_COMMON_HEADERS <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <map> <memory> <optional> <random>
                              <set> <span> <string> <string_view> <variant> <vector> <fmt/format.h>)

# add_precompiled(NAME headers...): a target whose headers others reuse by precompiled(TARGET NAME).
function(add_precompiled name)
  file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/generated/${name}.cpp CONTENT "")
  add_library(${name} OBJECT ${CMAKE_BINARY_DIR}/generated/${name}.cpp)
  target_link_libraries(${name} PRIVATE house fmt::fmt)
  target_precompile_headers(${name} PRIVATE ${ARGN})
endfunction()
function(precompiled target name)
  if(SENSORFARM_PCH)
    target_precompile_headers(${target} REUSE_FROM ${name})
  endif()
endfunction()
if(SENSORFARM_PCH)
  add_precompiled(common_headers ${SENSORFARM_COMMON_HEADERS})
endif()

# add_room(NAME [PUBLIC targets...] [PRIVATE targets...] [MODULES names...])
# MODULES: sources NAME/<name>.cpp that are loaded when they are first needed, as sensorfarm_<name>.so beside the program.
function(add_room name)
  cmake_parse_arguments(ROOM "" "" "PUBLIC;PRIVATE;MODULES" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/${name}/*.cpp)
  foreach(module ${ROOM_MODULES})
    list(REMOVE_ITEM sources ${CMAKE_SOURCE_DIR}/${name}/${module}.cpp)
    add_library(sensorfarm_${module} MODULE ${name}/${module}.cpp)
    set_target_properties(sensorfarm_${module} PROPERTIES PREFIX "" LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR})
    target_link_libraries(sensorfarm_${module} PRIVATE house)
  endforeach()
  if(sources)
    add_library(${name} STATIC ${sources})
    target_link_libraries(${name} PUBLIC house Threads::Threads ${ROOM_PUBLIC} PRIVATE ${ROOM_PRIVATE})
    precompiled(${name} common_headers)
  else()
    add_library(${name} INTERFACE)
    target_link_libraries(${name} INTERFACE house ${ROOM_PUBLIC})
  endif()
  foreach(module ${ROOM_MODULES})
    add_dependencies(${name} sensorfarm_${module})
  endforeach()
endfunction()
