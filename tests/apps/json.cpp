#include "tests/apps/json.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace sf {

struct Json::Tree {
  nlohmann::ordered_json root;

  const nlohmann::ordered_json& at(const std::string& pointer) const {
    static const nlohmann::ordered_json kNothing;
    const nlohmann::ordered_json::json_pointer where(pointer);
    if (root.contains(where)) return root.at(where);
    ADD_FAILURE() << "no value at " << pointer;
    return kNothing;
  }
};

Json::Json(const std::string& text) : tree_(std::make_unique<Tree>()) {
  tree_->root = nlohmann::ordered_json::parse(text, nullptr, false);
  EXPECT_FALSE(tree_->root.is_discarded()) << "not JSON: " << text.substr(0, 200);
}

Json::~Json() = default;

double Json::number(const std::string& pointer) const {
  const auto& value = tree_->at(pointer);
  EXPECT_TRUE(value.is_number()) << pointer << " is " << value.type_name();
  return value.is_number() ? value.get<double>() : 0.0;
}

std::string Json::text(const std::string& pointer) const {
  const auto& value = tree_->at(pointer);
  EXPECT_TRUE(value.is_string()) << pointer << " is " << value.type_name();
  return value.is_string() ? value.get<std::string>() : "";
}

bool Json::flag(const std::string& pointer) const {
  const auto& value = tree_->at(pointer);
  EXPECT_TRUE(value.is_boolean()) << pointer << " is " << value.type_name();
  return value.is_boolean() && value.get<bool>();
}

std::size_t Json::size(const std::string& pointer) const {
  const auto& value = tree_->at(pointer);
  EXPECT_TRUE(value.is_structured()) << pointer << " is " << value.type_name();
  return value.size();
}

bool Json::has(const std::string& pointer) const {
  return tree_->root.contains(nlohmann::ordered_json::json_pointer(pointer));
}

bool Json::is_null(const std::string& pointer) const { return tree_->at(pointer).is_null(); }

std::vector<std::string> Json::keys() const {
  std::vector<std::string> names;
  for (const auto& item : tree_->root.items()) names.push_back(item.key());
  return names;
}

Json run_json(const Words& arguments) { return Json(run_successfully(arguments).out); }

}  // namespace sf
