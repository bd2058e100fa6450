#pragma once
// Poses and twists as named tuples: `x, y, z, yaw = robot.pose`, `robot.pose.x`.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>

#include "sensorfarm/types.h"

namespace sensorfarm::python {

/// Returns the named tuple's class, created once per library; it exists as long as the interpreter.
inline pybind11::handle tuple_type(const char* name, const char* fields) {
  return pybind11::module_::import("collections").attr("namedtuple")(name, fields).release();
}
inline pybind11::handle pose_type() {
  static const pybind11::handle type = tuple_type("Pose", "x y z yaw");
  return type;
}
inline pybind11::handle twist_type() {
  static const pybind11::handle type = tuple_type("Twist", "forward left turn");
  return type;
}

}  // namespace sensorfarm::python

namespace pybind11::detail {

template <>
struct type_caster<sensorfarm::Pose> {
  PYBIND11_TYPE_CASTER(sensorfarm::Pose, const_name("Pose"));
  bool load(handle from, bool convert) {
    make_caster<std::array<double, 4>> four;
    if (!four.load(from, convert)) return false;
    const std::array<double, 4>& p = four;
    value = {p[0], p[1], p[2], p[3]};
    return true;
  }
  static handle cast(const sensorfarm::Pose& p, return_value_policy, handle) {
    return sensorfarm::python::pose_type()(p.x, p.y, p.z, p.yaw).release();
  }
};

template <>
struct type_caster<sensorfarm::Twist> {
  PYBIND11_TYPE_CASTER(sensorfarm::Twist, const_name("Twist"));
  bool load(handle from, bool convert) {
    make_caster<std::array<double, 3>> three;
    if (!three.load(from, convert)) return false;
    const std::array<double, 3>& t = three;
    value = {t[0], t[1], t[2]};
    return true;
  }
  static handle cast(const sensorfarm::Twist& t, return_value_policy, handle) {
    return sensorfarm::python::twist_type()(t.forward, t.left, t.turn).release();
  }
};

}  // namespace pybind11::detail
