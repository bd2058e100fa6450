# GLSL -> SPIR-V -> a C header, at build time.

find_program(GLSLANG glslangValidator REQUIRED)
find_program(AWK awk REQUIRED)

# add_records(SOURCES header.h...): lets kernels `#include "shaders/header.glsl"`, which has the header's structs with
# their accessors (cmake/records.awk). Sets the caller's variable SOURCES to sources that check the layouts.
function(add_records sources)
  foreach(header ${ARGN})
    string(REGEX REPLACE "\\.h$" "" name ${header})
    set(accessors ${CMAKE_BINARY_DIR}/generated/shaders/${name}.glsl)
    set(check ${CMAKE_BINARY_DIR}/generated/shaders/${name}_layout.cpp)
    get_filename_component(folder ${accessors} DIRECTORY)
    file(MAKE_DIRECTORY ${folder})
    add_custom_command(
      OUTPUT ${accessors} ${check}
      COMMAND ${AWK} -f ${CMAKE_SOURCE_DIR}/cmake/records.awk ${header} > ${accessors}
      COMMAND ${AWK} -v layouts=1 -f ${CMAKE_SOURCE_DIR}/cmake/records.awk ${header} > ${check}
      WORKING_DIRECTORY ${CMAKE_SOURCE_DIR}
      DEPENDS ${CMAKE_SOURCE_DIR}/${header} ${CMAKE_SOURCE_DIR}/cmake/records.awk
      COMMENT "Writing accessors of ${header}"
      VERBATIM)
    list(APPEND all ${accessors})
    list(APPEND checks ${check})
  endforeach()
  set_property(GLOBAL PROPERTY RECORD_ACCESSORS ${all})
  set(${sources} ${checks} PARENT_SCOPE)
endfunction()

# add_shaders(TARGET file.comp...): `#include "shaders/file.comp.h"` provides `file_comp_spv`.
function(add_shaders target)
  get_property(records GLOBAL PROPERTY RECORD_ACCESSORS)
  foreach(source ${ARGN})
    get_filename_component(name ${source} NAME)
    string(REPLACE "." "_" symbol ${name})
    set(header ${CMAKE_BINARY_DIR}/generated/shaders/${name}.h)
    add_custom_command(
      OUTPUT ${header}
      COMMAND ${CMAKE_COMMAND} -E make_directory ${CMAKE_BINARY_DIR}/generated/shaders
      COMMAND ${GLSLANG} -V --quiet --target-env vulkan1.2 -I${CMAKE_SOURCE_DIR} -I${CMAKE_BINARY_DIR}/generated --vn ${symbol}_spv -o ${header} ${source}
              --depfile ${header}.d
      DEPENDS ${source} ${records} DEPFILE ${header}.d
      COMMENT "Compiling ${name}"
      VERBATIM)
    list(APPEND headers ${header})
  endforeach()
  add_custom_target(${target}_headers DEPENDS ${headers})
  add_library(${target} INTERFACE)
  target_include_directories(${target} INTERFACE ${CMAKE_BINARY_DIR}/generated)
  add_dependencies(${target} ${target}_headers)
endfunction()
