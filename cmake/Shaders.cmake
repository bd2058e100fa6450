# GLSL -> SPIR-V -> a C header, at build time.

find_program(GLSLANG glslangValidator REQUIRED)

# add_shaders(TARGET file.comp...): `#include "shaders/file.comp.h"` gives `file_comp_spv`.
function(add_shaders target)
  foreach(source ${ARGN})
    get_filename_component(name ${source} NAME)
    string(REPLACE "." "_" symbol ${name})
    set(header ${CMAKE_BINARY_DIR}/generated/shaders/${name}.h)
    add_custom_command(
      OUTPUT ${header}
      COMMAND ${CMAKE_COMMAND} -E make_directory ${CMAKE_BINARY_DIR}/generated/shaders
      COMMAND ${GLSLANG} -V --quiet --target-env vulkan1.2 -I${CMAKE_SOURCE_DIR} --vn ${symbol}_spv -o ${header} ${source}
              --depfile ${header}.d
      DEPENDS ${source} DEPFILE ${header}.d
      COMMENT "Compiling ${name}"
      VERBATIM)
    list(APPEND headers ${header})
  endforeach()
  add_custom_target(${target}_headers DEPENDS ${headers})
  add_library(${target} INTERFACE)
  target_include_directories(${target} INTERFACE ${CMAKE_BINARY_DIR}/generated)
  add_dependencies(${target} ${target}_headers)
endfunction()
