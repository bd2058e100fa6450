# The list of sensor types: one line each in sensors/CMakeLists.txt.

# farm_sensor(WIRE_ID NAME DEVICE|HOST): sensors/NAME.h, sensors/NAME.cpp (which defines `NAME_type`), the kernel
# shaders/NAME.comp for DEVICE, and the tests tests/sensors/NAME_test.cpp.
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
  if(NOT id MATCHES "^[0-9]+$" OR id LESS 1 OR id GREATER 63)
    message(FATAL_ERROR "farm_sensor(${id} ${name} ${where}): expected a wire id from 1 to 63")
  endif()
  get_property(known GLOBAL PROPERTY SENSOR_TYPES)
  foreach(type ${known})
    if(type MATCHES "^${id}/" OR type MATCHES "/${name}$")
      message(FATAL_ERROR "farm_sensor(${id} ${name} ${where}): ${type} has that id or name already")
    endif()
  endforeach()
  set_property(GLOBAL APPEND PROPERTY SENSOR_TYPES ${id}/${name})
endfunction()

# write_sensor_types(FILE): writes a source that defines sensors::built_in_sensor_types(), all sensor types sorted by id.
function(write_sensor_types file)
  get_property(known GLOBAL PROPERTY SENSOR_TYPES)
  list(SORT known COMPARE NATURAL)
  set(declared "")
  set(listed "")
  foreach(type ${known})
    string(REGEX REPLACE ".*/" "" name ${type})
    string(APPEND declared "extern const SensorType ${name}_type;\n")
    string(APPEND listed "&${name}_type, ")
  endforeach()
  file(CONFIGURE OUTPUT ${file} @ONLY CONTENT "// Written from sensors/CMakeLists.txt.
#include \"sensors/sensor_type.h\"

namespace sf::sensors {

@declared@
std::span<const SensorType* const> built_in_sensor_types() {
  static constexpr const SensorType* kSensorTypes[] = {@listed@};
  return kSensorTypes;
}

}  // namespace sf::sensors
")
endfunction()
