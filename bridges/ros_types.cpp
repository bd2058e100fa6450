#include "bridges/ros_types.h"

#include <fmt/format.h>

#include <charconv>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <vector>

#include "netio/signature.h"

namespace sf::bridges {

namespace {

/// Ids of primitive types (type_description_interfaces/msg/FieldType). `char` is uint8 in ROS 2.
const std::map<std::string_view, int> kTypeIds{
    {"int8", 2},   {"uint8", 3},    {"int16", 4},    {"uint16", 5}, {"int32", 6}, {"uint32", 7}, {"int64", 8},
    {"uint64", 9}, {"float32", 10}, {"float64", 11}, {"bool", 15},  {"byte", 16}, {"char", 3},   {"string", 17},
};
constexpr int kNested = 1, kBoundedString = 21;                     // in place of the above
constexpr int kArray = 48, kBoundedSequence = 96, kSequence = 144;  // added to the above

struct Field {
  std::string name;
  int type_id = 0;
  std::uint32_t capacity = 0, string_capacity = 0;
  std::string nested;  ///< "package/msg/Name"; empty: a primitive type
};
using Fields = std::vector<Field>;

std::optional<std::uint32_t> number(std::string_view digits) {
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
  return value;
}

/// Converts "package/Name" to "package/msg/Name". Parts of actions already have full names.
std::string whole_name(std::string_view type) {
  const std::size_t slash = type.find('/');
  if (type.find('/', slash + 1) != std::string_view::npos) return std::string(type);
  return std::string(type.substr(0, slash)) + "/msg" + std::string(type.substr(slash));
}

/// Removes "[3]", "[<=3]" or "[]" from the end of `type`.
bool read_extent(std::string_view& type, Field& field) {
  const std::size_t bracket = type.find('[');
  if (bracket == std::string_view::npos) return true;
  if (type.back() != ']') return false;
  std::string_view extent = type.substr(bracket + 1, type.size() - bracket - 2);
  type = type.substr(0, bracket);
  field.type_id = extent.empty() ? kSequence : kArray;
  if (extent.empty()) return true;
  if (extent.starts_with("<=")) {
    field.type_id = kBoundedSequence;
    extent.remove_prefix(2);
  }
  const auto capacity = number(extent);
  field.capacity = capacity.value_or(0);
  return capacity.has_value();
}

std::optional<Field> read_field(std::string_view type, const std::string& name) {
  Field field{.name = name};
  if (name.empty() || !read_extent(type, field)) return std::nullopt;
  if (type.find('/') != std::string_view::npos) {
    field.nested = whole_name(type);
    field.type_id += kNested;
  } else if (type.starts_with("string<=")) {
    const auto capacity = number(type.substr(8));
    if (!capacity) return std::nullopt;
    field.string_capacity = *capacity;
    field.type_id += kBoundedString;
  } else {
    const auto known = kTypeIds.find(type);
    if (known == kTypeIds.end()) return std::nullopt;
    field.type_id += known->second;
  }
  return field;
}

/// Parses a line of a definition.
/// @return false: it cannot be parsed
bool read_line(const std::string& line, Fields& fields) {
  std::istringstream words(line.substr(0, line.find('#')));
  std::string type, name, rest;
  words >> type >> name >> rest;
  if (type.empty()) return true;
  if (name.find('=') != std::string::npos || rest.starts_with('=')) return true;  // a constant
  const auto field = read_field(type, name);
  if (field) fields.push_back(*field);
  return field.has_value();
}

/// Types by full name. Empty if the text cannot be parsed.
std::map<std::string, Fields> read_types(std::string_view type, std::string_view text) {
  std::map<std::string, Fields> types;
  std::string current(type);
  std::istringstream lines{std::string(text)};
  std::string line;
  types[current];
  while (std::getline(lines, line)) {
    if (line.starts_with("====")) continue;
    if (line.starts_with("MSG: ")) {
      current = whole_name(std::string_view(line).substr(5));
      types[current].clear();
    } else if (!read_line(line, types[current])) {
      return {};
    }
  }
  // An IDL structure needs a member, so add one to an empty message.
  for (auto& [name, fields] : types)
    if (fields.empty()) fields.push_back({.name = "structure_needs_at_least_one_member", .type_id = 3});
  return types;
}

std::string type_description_json(const std::string& name, const Fields& fields) {
  std::string json = fmt::format(R"({{"type_name": "{}", "fields": [)", name);
  for (const Field& field : fields)
    json += fmt::format(
        R"({}{{"name": "{}", "type": {{"type_id": {}, "capacity": {}, "string_capacity": {}, "nested_type_name": "{}"}}}})",
        &field == fields.data() ? "" : ", ", field.name, field.type_id, field.capacity, field.string_capacity,
        field.nested);
  return json + "]}";
}

/// Adds all types that `name` uses.
/// @return false: a type is missing
bool add_needed(const std::string& name, const std::map<std::string, Fields>& types, std::set<std::string>& needed) {
  const auto found = types.find(name);
  if (found == types.end()) return false;
  for (const Field& field : found->second)
    if (!field.nested.empty() && needed.insert(field.nested).second && !add_needed(field.nested, types, needed))
      return false;
  return true;
}

}  // namespace

std::string dds_type(std::string_view type) {
  std::string name;
  for (const char c : type.substr(0, type.rfind('/'))) name += c == '/' ? std::string("::") : std::string(1, c);
  return name + "::dds_::" + std::string(type.substr(type.rfind('/') + 1)) + "_";
}

std::string type_hash(std::string_view type, std::string_view text) {
  const auto types = read_types(type, text);
  const std::string name(type);
  std::set<std::string> needed;
  if (!add_needed(name, types, needed)) return {};
  std::string json = R"({"type_description": )" + type_description_json(name, types.at(name)) +
                     R"(, "referenced_type_descriptions": [)";
  for (const std::string& other : needed)
    json += (other == *needed.begin() ? "" : ", ") + type_description_json(other, types.at(other));
  json += "]}";
  std::string hash = "RIHS01_";
  for (const std::uint8_t byte : netio::sha256({reinterpret_cast<const std::uint8_t*>(json.data()), json.size()}))
    hash += fmt::format("{:02x}", byte);
  return hash;
}

std::string type_user_data(std::string_view type, std::string_view definition) {
  const std::string hash = type_hash(type, definition);
  return hash.empty() ? hash : "typehash=" + hash + ";";
}

}  // namespace sf::bridges
