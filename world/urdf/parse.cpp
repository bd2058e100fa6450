// The URDF plug-in: shapes of links in the robot's frame.

#include <console_bridge/console.h>
#include <fmt/format.h>
#include <urdf_parser/urdf_parser.h>

#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <mutex>

#include "base/error.h"
#include "world/meshes/urdf_robot.h"

namespace sf::world {

namespace {

constexpr int kMostDepth = 1'000;  ///< of links in a chain

/// Collects the parser's messages, which it would print, during its lifetime.
class Messages : public console_bridge::OutputHandler {
 public:
  Messages() : guard_(lock()) { console_bridge::useOutputHandler(this); }
  ~Messages() override { console_bridge::restorePreviousOutputHandler(); }
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR && text_.size() < 500)
      text_ += (text_.empty() ? "" : "; ") + text;
  }
  const std::string& text() const { return text_; }

 private:
  static std::mutex& lock() {
    static std::mutex lock;
    return lock;
  }
  std::scoped_lock<std::mutex> guard_;
  std::string text_;
};

/// Rounds away the last bits, in which C libraries differ: the parser computes quaternions by their sine.
double without_last_bits(double part) { return std::round(part * 0x1p45) * 0x1p-45; }

glm::dmat4 transform_of(const urdf::Pose& pose) {
  const urdf::Rotation& r = pose.rotation;
  const glm::dquat q(without_last_bits(r.w), without_last_bits(r.x), without_last_bits(r.y), without_last_bits(r.z));
  glm::dmat4 X = glm::mat4_cast(glm::normalize(q));
  X[3] = {pose.position.x, pose.position.y, pose.position.z, 1.0};
  return X;
}

/// Returns the colour of a material, taken as linear, like those of OBJ files.
std::optional<glm::dvec3> color_of(const urdf::MaterialSharedPtr& material) {
  if (!material || !material->texture_filename.empty()) return std::nullopt;
  return glm::dvec3{material->color.r, material->color.g, material->color.b};
}

UrdfShape shape_of(const urdf::Geometry& geometry, const glm::dmat4& X) {
  using Kind = UrdfShape::Kind;
  const auto size = [](const urdf::Vector3& v) { return glm::dvec3{v.x, v.y, v.z}; };
  switch (geometry.type) {
    case urdf::Geometry::BOX:
      return {Kind::box, "", size(static_cast<const urdf::Box&>(geometry).dim), X};
    case urdf::Geometry::SPHERE:
      return {Kind::sphere, "", glm::dvec3(static_cast<const urdf::Sphere&>(geometry).radius), X};
    case urdf::Geometry::CYLINDER: {
      const auto& c = static_cast<const urdf::Cylinder&>(geometry);
      return {Kind::cylinder, "", {c.radius, c.radius, c.length}, X};
    }
    default: {
      const auto& mesh = static_cast<const urdf::Mesh&>(geometry);
      return {Kind::mesh, mesh.filename, size(mesh.scale), X};
    }
  }
}

void add_link(const urdf::Link& link, const glm::dmat4& X, int depth, UrdfRobot& out) {
  if (depth > kMostDepth) throw base::InputError(fmt::format("more than {} links in a chain", kMostDepth));
  UrdfLink& row = out.links.emplace_back();
  row.name = link.name;
  for (const auto& visual : link.visual_array)
    if (visual && visual->geometry) {
      row.visual.push_back(shape_of(*visual->geometry, X * transform_of(visual->origin)));
      row.visual.back().color = color_of(visual->material);
    }
  for (const auto& part : link.collision_array)
    if (part && part->geometry) row.collision.push_back(shape_of(*part->geometry, X * transform_of(part->origin)));
  for (const auto& joint : link.child_joints) out.movable += joint->type != urdf::Joint::FIXED;
  for (const auto& child : link.child_links)
    add_link(*child, X * transform_of(child->parent_joint->parent_to_joint_origin_transform), depth + 1, out);
}

UrdfRobot read(const std::string& file, const std::string& text) {
  const Messages messages;
  const urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(text);
  const std::string& reasons = messages.text();
  if (!model || !model->getRoot())
    throw base::InputError(file, 0,
                           fmt::format("is no readable URDF: {}", reasons.empty() ? "no reason is given" : reasons));
  UrdfRobot robot;
  try {
    add_link(*model->getRoot(), glm::dmat4(1.0), 0, robot);
  } catch (const base::InputError& error) {
    throw base::InputError(file, 0, error.what());
  }
  robot.parser_errors = reasons;
  return robot;
}

}  // namespace

extern "C" {
extern const UrdfPlugin sensorfarm_urdf;
const UrdfPlugin sensorfarm_urdf{read};
}

}  // namespace sf::world
