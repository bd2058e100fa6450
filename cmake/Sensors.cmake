# The list of sensor kinds: one line each in sensors/CMakeLists.txt.

# farm_sensor(WIRE_ID NAME DEVICE|HOST): sensors/NAME.h, sensors/NAME.cpp (which defines `NAME_kind`), its kernel
# shaders/NAME.comp where it has one, and its proof tests/sensors/NAME_test.cpp.
function(farm_sensor id name where)
  set(files sensors/${name}.h sensors/${name}.cpp tests/sensors/${name}_test.cpp)
  if(where STREQUAL DEVICE)
    list(APPEND files shaders/${name}.comp)
  elseif(NOT where STREQUAL HOST)
    message(FATAL_ERROR "farm_sensor(${id} ${name} ${where}): expected DEVICE or HOST")
  endif()
  foreach(file ${files})
    if(NOT EXISTS ${CMAKE_SOURCE_DIR}/${file})
      message(FATAL_ERROR "farm_sensor(${id} ${name} ${where}): ${file} is missing")
    endif()
  endforeach()
  if(NOT id MATCHES "^[0-9]+$" OR id LESS 1 OR id GREATER 31)
    message(FATAL_ERROR "farm_sensor(${id} ${name} ${where}): expected a wire id from 1 to 31")
  endif()
  get_property(known GLOBAL PROPERTY SENSOR_KINDS)
  foreach(kind ${known})
    if(kind MATCHES "^${id}/" OR kind MATCHES "/${name}$")
      message(FATAL_ERROR "farm_sensor(${id} ${name} ${where}): ${kind} has that id or name already")
    endif()
  endforeach()
  set_property(GLOBAL APPEND PROPERTY SENSOR_KINDS ${id}/${name})
endfunction()

# write_kinds(FILE): every kind by id, as a source that defines sensors::kinds().
function(write_kinds file)
  get_property(known GLOBAL PROPERTY SENSOR_KINDS)
  list(SORT known COMPARE NATURAL)
  set(declared "")
  set(listed "")
  foreach(kind ${known})
    string(REGEX REPLACE ".*/" "" name ${kind})
    string(APPEND declared "extern const SensorKind ${name}_kind;\n")
    string(APPEND listed "&${name}_kind, ")
  endforeach()
  file(CONFIGURE OUTPUT ${file} @ONLY CONTENT "// Written from sensors/CMakeLists.txt.
#include \"sensors/kind.h\"

namespace sf::sensors {

@declared@
std::span<const SensorKind* const> kinds() {
  static constexpr const SensorKind* kKinds[] = {@listed@};
  return kKinds;
}

}  // namespace sf::sensors
")
endfunction()
