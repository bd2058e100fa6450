# A module is a folder, a namespace, a target and a folder of tests.

find_package(fmt REQUIRED)
find_package(glm REQUIRED)
find_package(Threads REQUIRED)
find_package(Vulkan REQUIRED)
find_package(ZLIB REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_library(SODIUM sodium REQUIRED)  # libsodium-dev
find_library(ZSTD zstd REQUIRED)  # libzstd-dev
find_library(MUPARSER muparser REQUIRED)  # libmuparser-dev
find_file(THREE_JS three.min.js PATHS /usr/share/javascript/three)  # libjs-three, for the live view; optional
find_file(THREE_JS_LICENSE copyright PATHS /usr/share/doc/libjs-three NO_DEFAULT_PATH)
find_path(TOMLPLUSPLUS toml++/toml.h REQUIRED)  # headers only (libtomlplusplus-dev)

# Without plug-ins, the program supports everything that needs no heavy library, and names the plug-in that a command
# lacks.
option(SENSORFARM_BUILD_PLUGINS "Build the plug-ins: figures, videos, VTK, OpenCV, GDAL, ROS 2, MPI, Python" ON)
if(SENSORFARM_BUILD_PLUGINS)
  include(PluginLibraries)
endif()

# Build flags of all targets. Contraction is off so that host and device round in the same way. All code is compiled with
# -fPIC, since it may be part of a shared library and precompiled headers need equal flags. g++ 12 has false positives for
# overlapping strings (-Wrestrict), for array bounds with precompiled headers, and for moved variants
# (-Wmaybe-uninitialized).
add_library(project_options INTERFACE)
target_include_directories(project_options INTERFACE ${CMAKE_SOURCE_DIR})
target_link_libraries(project_options INTERFACE glm::glm)
target_compile_definitions(project_options INTERFACE GLM_FORCE_CTOR_INIT)  # vectors start at zero
target_compile_options(project_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wno-missing-field-initializers
                       "$<$<CXX_COMPILER_ID:GNU>:-Wno-restrict;-Wno-array-bounds;-Wno-stringop-overflow;-Wno-stringop-overread;-Wno-maybe-uninitialized>" -ffp-contract=off -fPIC -fno-semantic-interposition
                       $<$<BOOL:${SENSORFARM_WERROR}>:-Werror>)
if(SENSORFARM_SANITIZE)
  target_compile_options(project_options INTERFACE -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  target_link_options(project_options INTERFACE -fsanitize=address,undefined)
  target_sources(project_options INTERFACE ${CMAKE_SOURCE_DIR}/tests/keep_loaded.cpp)
endif()

# Release builds use -O2, and -O3 in modules marked HOT, where benchmarks show a gain (docs/developing.md).
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")
add_library(hot INTERFACE)
target_compile_options(hot INTERFACE $<$<CONFIG:Release>:-O3>)

# Precompiled standard headers save a third of the build time. Sources still include all headers that they use, which
# -DSENSORFARM_PCH=OFF verifies.
option(SENSORFARM_PCH "Precompile the headers that most sources include" ON)
set(SENSORFARM_COMMON_HEADERS <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <map> <memory> <optional> <random>
                              <set> <span> <string> <string_view> <variant> <vector> <fmt/format.h>
                              <glm/ext/vector_double2.hpp> <glm/ext/vector_double3.hpp> <glm/geometric.hpp>)

# add_precompiled(NAME [links...] HEADERS headers...): a target whose precompiled headers other targets reuse by
# precompiled(TARGET NAME).
function(add_precompiled name)
  cmake_parse_arguments(PCH "" "" "HEADERS" ${ARGN})
  file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/generated/${name}.cpp CONTENT "")
  add_library(${name} OBJECT ${CMAKE_BINARY_DIR}/generated/${name}.cpp)
  target_link_libraries(${name} PRIVATE project_options fmt::fmt ${PCH_UNPARSED_ARGUMENTS})
  target_precompile_headers(${name} PRIVATE ${PCH_HEADERS})
endfunction()
function(precompiled target name)
  if(SENSORFARM_PCH)
    target_precompile_headers(${target} REUSE_FROM ${name})
  endif()
endfunction()

# With SENSORFARM_CHECKED, every module is built a second time, as NAME_checked, with AddressSanitizer and UBSan, and the
# objects of the test programs are also linked with these modules (tests/CMakeLists.txt). Instrumenting the tests as well
# would cost three times as much. -Og without warnings, which the first build reports, takes 60 % of the time of -O1.
# Checks that AddressSanitizer repeats (null pointers, sizes of objects) would take a fifth of the compilation.
set(SENSORFARM_CHECKED OFF CACHE STRING "Build modules a second time, with sanitizers, and their tests with them: ON, OFF, or a list of modules")
function(is_checked module result)
  string(REPLACE "," ";" chosen "${SENSORFARM_CHECKED}")
  if(NOT SENSORFARM_CHECKED)
    set(${result} FALSE PARENT_SCOPE)
  elseif(module IN_LIST chosen OR SENSORFARM_CHECKED STREQUAL ON)
    set(${result} TRUE PARENT_SCOPE)
  else()
    set(${result} FALSE PARENT_SCOPE)
  endif()
endfunction()
if(SENSORFARM_CHECKED)
  add_library(checked INTERFACE)
  target_compile_options(checked INTERFACE -Og -g1 -w -UNDEBUG -D_GLIBCXX_ASSERTIONS -fsanitize=address,undefined
                                           -fno-sanitize=null,object-size -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  # Millions of addresses in the sanitizers' tables would be relocated at each start (docs/developing.md).
  target_link_options(checked INTERFACE -fsanitize=address,undefined -fno-lto -no-pie)
  # Types only (compare_types()). Indices of archives must list the objects' own symbols: with the compiler's plug-in they
  # list what link-time optimisation could emit, and the linker adds a member again for each symbol that it lacks.
  target_link_options(project_options INTERFACE -fno-lto)
  set(CMAKE_CXX_ARCHIVE_CREATE "<CMAKE_AR> --plugin=/dev/null qc <TARGET> <LINK_FLAGS> <OBJECTS>")
  set(CMAKE_CXX_ARCHIVE_APPEND "<CMAKE_AR> --plugin=/dev/null q <TARGET> <LINK_FLAGS> <OBJECTS>")
  set(CMAKE_CXX_ARCHIVE_FINISH "")
endif()
if(SENSORFARM_PCH)
  add_precompiled(common_headers HEADERS ${SENSORFARM_COMMON_HEADERS})
  add_precompiled(common_headers_hot hot HEADERS ${SENSORFARM_COMMON_HEADERS})
  if(SENSORFARM_CHECKED)
    add_precompiled(common_headers_checked checked HEADERS ${SENSORFARM_COMMON_HEADERS})
  endif()
endif()

# Modules, their instrumented copies and tests are compiled in groups of sixteen sources, in a third of the time. This
# requires distinct file-local names within a module. `script/tidy sources` compiles each source alone, which reveals
# missing includes. OFF rebuilds less after a change.
option(SENSORFARM_UNITY "Compile several sources at a time" ON)
function(compile_together target)
  set(batch 16 ${ARGN})
  list(GET batch -1 batch)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${SENSORFARM_UNITY} UNITY_BUILD_BATCH_SIZE ${batch})
  # g++ mistakes types in a source's unnamed namespace for a header's in unity builds.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endfunction()

# With SENSORFARM_CHECKED, the objects of modules contain their types in addition to their code (4 % more compile time).
# Target odr compares the types across sources without generating code, and fails if two sources define one type
# differently (one-definition rule).
function(compare_types target)
  if(SENSORFARM_CHECKED)
    target_compile_options(${target} PRIVATE -flto -ffat-lto-objects)
    set_property(GLOBAL APPEND PROPERTY SENSORFARM_COMPARED $<TARGET_OBJECTS:${target}>)
  endif()
endfunction()
function(add_odr_target)
  get_property(objects GLOBAL PROPERTY SENSORFARM_COMPARED)
  add_custom_target(odr COMMAND ${CMAKE_CXX_COMPILER} -r -flto -flinker-output=rel -Wodr -Wlto-type-mismatch -Werror ${objects} -o odr.o
                    DEPENDS ${objects} COMMAND_EXPAND_LISTS VERBATIM COMMENT "Comparing types across sources")
endfunction()

# add_module(NAME [HOT] [FOLDER folder] [UNIT sources] [PUBLIC targets...] [PRIVATE targets...] [SOURCES sources...] [PLUGINS names...])
# FOLDER: folder of the sources, default NAME; a folder below another module's belongs to this module only. UNIT: sources
# per unit, default 16. SOURCES: files generated at configure time, in addition to the folder's. PLUGINS: the source
# FOLDER/<name>.cpp or the folder FOLDER/<name>/ becomes sensorfarm_<name>.so in the program's folder, which is loaded at
# first use.
function(add_module name)
  cmake_parse_arguments(MODULE "HOT" "FOLDER;UNIT" "PUBLIC;PRIVATE;SOURCES;PLUGINS" ${ARGN})
  if(NOT MODULE_FOLDER)
    set(MODULE_FOLDER ${name})
  endif()
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/${MODULE_FOLDER}/*.cpp)
  if(NOT MODULE_FOLDER MATCHES "/")
    list(FILTER sources EXCLUDE REGEX "/(robots|scene|vision)/(device|estimation|rendering)/")
  endif()
  foreach(plugin ${MODULE_PLUGINS})
    set(plugin_sources ${CMAKE_SOURCE_DIR}/${MODULE_FOLDER}/${plugin}.cpp)
    if(IS_DIRECTORY ${CMAKE_SOURCE_DIR}/${MODULE_FOLDER}/${plugin})
      file(GLOB plugin_sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/${MODULE_FOLDER}/${plugin}/*.cpp)
    endif()
    list(REMOVE_ITEM sources ${plugin_sources})
    if(NOT SENSORFARM_BUILD_PLUGINS)
      continue()
    endif()
    add_library(sensorfarm_${plugin} MODULE ${plugin_sources})
    set_target_properties(sensorfarm_${plugin} PROPERTIES PREFIX "" LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR})
    target_link_libraries(sensorfarm_${plugin} PRIVATE project_options)
  endforeach()
  add_library(${name} STATIC ${sources} ${MODULE_SOURCES})
  target_link_libraries(${name} PUBLIC project_options Threads::Threads ${MODULE_PUBLIC} PRIVATE ${MODULE_PRIVATE})
  if(MODULE_HOT)
    target_compile_options(${name} PRIVATE $<TARGET_PROPERTY:hot,INTERFACE_COMPILE_OPTIONS>)
    precompiled(${name} common_headers_hot)
  else()
    precompiled(${name} common_headers)
  endif()
  compile_together(${name} ${MODULE_UNIT})
  compare_types(${name})
  foreach(plugin ${MODULE_PLUGINS})
    if(SENSORFARM_BUILD_PLUGINS)
      add_dependencies(${name} sensorfarm_${plugin})
    endif()
  endforeach()
  set_property(GLOBAL PROPERTY SENSORFARM_BELOW_${name} ${MODULE_PUBLIC} ${MODULE_PRIVATE})
  is_checked(${name} checked)
  if(checked)
    add_library(${name}_checked OBJECT ${sources} ${MODULE_SOURCES})
    target_link_libraries(${name}_checked PRIVATE project_options Threads::Threads ${MODULE_PUBLIC} ${MODULE_PRIVATE} checked)
    precompiled(${name}_checked common_headers_checked)
    compile_together(${name}_checked ${MODULE_UNIT})
  endif()
endfunction()

# add_checked_program(NAME OBJECTS targets... MODULES modules... [LIBRARIES targets...]): links program NAME from the
# objects of targets, all modules that `modules` depend on, and the instrumented ones in place of theirs. The linker keeps
# the first copy of an inline function, which is the instrumented one.
function(add_checked_program name)
  cmake_parse_arguments(PROGRAM "" "" "OBJECTS;MODULES;LIBRARIES" ${ARGN})
  set(seen "")
  set(modules "")
  set(libraries ${PROGRAM_LIBRARIES})
  set(open ${PROGRAM_MODULES})
  while(open)
    list(POP_FRONT open next)
    if(next IN_LIST seen)
      continue()
    endif()
    list(APPEND seen ${next})
    if(TARGET ${next}_checked)
      list(APPEND modules ${next})
    else()
      list(APPEND libraries ${next})
    endif()
    get_property(below GLOBAL PROPERTY SENSORFARM_BELOW_${next})
    list(APPEND open ${below})
  endwhile()
  set(objects ${PROGRAM_OBJECTS})
  list(TRANSFORM modules REPLACE "(.+)" "$<TARGET_OBJECTS:\\1_checked>")
  list(TRANSFORM objects REPLACE "(.+)" "$<TARGET_OBJECTS:\\1>")
  list(REMOVE_DUPLICATES libraries)
  add_executable(${name} ${CMAKE_SOURCE_DIR}/tests/keep_loaded.cpp ${modules} ${objects})
  target_link_libraries(${name} PRIVATE checked Threads::Threads ${libraries})
endfunction()
