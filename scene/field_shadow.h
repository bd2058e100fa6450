#pragma once
// The shadow of a height field in a distant light, such as the sun.
//
// F(t), the height above the surface of the ray from a point to the light, is linear between the lines of the grid and
// the diagonals (field_view.h), so its least value is at one of these. Blocks of the field's pyramid that are certainly
// below the ray are passed over.

#include <glm/ext/vector_float3.hpp>

#include "scene/rasterizer.h"

namespace sf::scene {

class FieldShadow {
 public:
  FieldShadow() = default;
  /// @param terrain with a field, which must outlive this object  @param p_W [m] the sensor's position
  /// @param to_light unit vector in the world
  FieldShadow(const Terrain& terrain, glm::dvec3 p_W, glm::dvec3 to_light);
  bool empty() const { return field_ == nullptr; }
  /// Returns whether the ray to the light passes the surface more than `room` [m] below, or begins there.
  /// @param p [m] in the world's axes, from the sensor
  bool hides(glm::vec3 p, float room) const;

 private:
  struct Ray;
  struct Exit;
  bool enter(Ray& ray) const;
  Exit exit_of(const Ray& ray, std::int32_t level) const;
  bool leave(Ray& ray, const Exit& exit, std::int32_t level) const;
  bool is_clear(const Ray& ray, std::int32_t level, double to) const;
  bool is_hidden(const Ray& ray, double to, double room) const;

  const HeightField* field_ = nullptr;
  glm::dmat3 X_{1.0};      ///< from the world's axes to cells and metres of height
  glm::dvec3 from_{};      ///< the sensor: [cells], height [m]
  glm::dvec3 to_light_{};  ///< [cells per metre] and height [m per metre]
};

}  // namespace sf::scene
