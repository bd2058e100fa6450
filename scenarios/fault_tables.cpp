#include "scenarios/fault_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "base/suggest.h"
#include "record/run_info.h"

namespace sf::scenarios {

namespace {

using base::FaultKind;
using farm::Fault;
using world::TomlNode;
using world::TomlReader;

constexpr double kMostAmount = 1e12;
constexpr double kLongestFault = 1e9;  // [s]
constexpr double kMostRow = 1e9;

/// The parameter of a kind of fault.
struct FaultParameter {
  std::string_view key;  ///< empty: none
  double least = -kMostAmount, most = kMostAmount;
  std::string_view unit = {};
};
/// By FaultKind.
constexpr std::array<FaultParameter, base::kFaultNames.size()> kFaultParameters{{
    {"offset", -kMostAmount, kMostAmount, "units of the column"},
    {"rate", -kMostAmount, kMostAmount, "units of the column per second"},
    {"factor"},
    {""},
    {"amplitude", 1e-12, kMostAmount, "units of the column"},
    {"sigma", 0.0, kMostAmount, "units of the column"},
    {"step", 1e-12, kMostAmount, "units of the column"},
    {"swap"},
    {""},
    {"delay", 1e-9, 3600.0, "seconds"},
}};

const FaultParameter& parameter_of(FaultKind kind) { return kFaultParameters[static_cast<std::size_t>(kind)]; }

/// Whether the kind alters values of one column.
bool has_column(FaultKind kind) {
  return kind != FaultKind::stuck && kind != FaultKind::swap && kind != FaultKind::dropout && kind != FaultKind::delay;
}

const TomlNode& needed(const TomlReader& reader, const TomlNode& table, std::string_view key, std::string_view form) {
  const TomlNode* const node = world::find(table, key);
  if (node == nullptr) reader.fail(table, fmt::format("'{}' is missing; a fault has {}", key, form));
  return *node;
}

FaultKind kind_of(const TomlReader& reader, const TomlNode& table) {
  const TomlNode& node = needed(reader, table, "kind", "robot, sensor and kind");
  const std::string word = reader.text(table, "kind", "");
  const auto found = std::ranges::find(base::kFaultNames, word);
  if (found == base::kFaultNames.end())
    reader.fail(node, fmt::format("there is no fault '{}'{}", word, base::expected_one_of(word, base::kFaultNames)));
  return static_cast<FaultKind>(found - base::kFaultNames.begin());
}

void require_fault_keys(const TomlReader& reader, const TomlNode& table, FaultKind kind) {
  std::vector<std::string_view> keys{"robot", "sensor", "kind", "from", "until", "probability"};
  if (const std::string_view key = parameter_of(kind).key; !key.empty()) keys.push_back(key);
  if (kind == FaultKind::noise) keys.push_back("factor");
  if (has_column(kind)) keys.insert(keys.end(), {"column", "element"});
  reader.require_known(table, keys);
}

/// Reads "type" or "type:number".
void read_sensor(const TomlReader& reader, const TomlNode& table, Fault& fault) {
  const TomlNode& node = needed(reader, table, "sensor", "robot, sensor and kind");
  const std::string text = reader.text(table, "sensor", "");
  const std::size_t colon = std::min(text.find(':'), text.size());
  fault.type = text.substr(0, colon);
  if (colon == text.size()) return;
  const char* const end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data() + colon + 1, end, fault.sensor);
  if (error != std::errc() || last != end)
    reader.fail(node,
                fmt::format("'{}' is not a sensor; expected \"TYPE\" or \"TYPE:NUMBER\", such as \"laser:1\"", text));
}

/// Reads two numbers of elements or two names of columns.
void read_swap(const TomlReader& reader, const TomlNode& node, Fault& fault) {
  for (const TomlNode& item : node.items)
    if (item.kind == TomlNode::Kind::text)
      fault.swapped_columns.push_back(item.text);
    else if (item.kind == TomlNode::Kind::number && item.number >= 0.0 && item.number <= kMostRow &&
             item.number == std::floor(item.number))
      fault.swapped_elements.push_back(static_cast<std::uint32_t>(item.number));
  const std::size_t columns = fault.swapped_columns.size(), elements = fault.swapped_elements.size();
  if (node.items.size() != 2 || columns + elements != 2 || columns == 1)
    reader.fail(node, "'swap' expects two numbers of elements from 0, or two names of columns, such as [0, 5]");
}

void read_amount(const TomlReader& reader, const TomlNode& table, Fault& fault) {
  const FaultParameter& parameter = parameter_of(fault.kind);
  if (parameter.key.empty()) return;
  const std::string_view name = base::kFaultNames[static_cast<std::size_t>(fault.kind)];
  const TomlNode* const factor = world::find(table, "factor");
  fault.multiplies = fault.kind == FaultKind::noise && factor != nullptr;
  if (fault.multiplies) {
    if (world::find(table, "sigma") != nullptr)
      reader.fail(*factor, "noise has both 'factor' and 'sigma'; expected one of them");
    fault.amount = reader.number(*factor, "factor", 1.0, kMostAmount);
    return;
  }
  const std::string form =
      fmt::format("{} for the kind {}", fault.kind == FaultKind::noise ? "sigma or factor" : parameter.key, name);
  const TomlNode& node = needed(reader, table, parameter.key, form);
  if (fault.kind == FaultKind::swap) return read_swap(reader, node, fault);
  fault.amount = reader.number(node, parameter.key, parameter.least, parameter.most, parameter.unit);
}

Fault fault_of(const TomlReader& reader, const TomlNode& table) {
  Fault fault{.kind = kind_of(reader, table), .file = reader.file(), .line = table.line};
  require_fault_keys(reader, table, fault.kind);
  needed(reader, table, "robot", "robot, sensor and kind");
  fault.robot = reader.text(table, "robot", "");
  read_sensor(reader, table, fault);
  fault.column = reader.text(table, "column", "");
  if (world::find(table, "element") != nullptr)
    fault.element = static_cast<std::uint32_t>(reader.whole(table, "element", 0, kMostRow));
  read_amount(reader, table, fault);
  fault.from = reader.number(table, "from", 0.0, 0.0, kLongestFault, "seconds");
  if (const TomlNode* until = world::find(table, "until")) {
    fault.until = reader.number(*until, "until", 0.0, kLongestFault, "seconds");
    if (fault.until <= fault.from)
      reader.fail(*until, fmt::format("the fault ends at {:g} s, not after its start; expected 'until' above {:g}",
                                      fault.until, fault.from));
  }
  if (fault.kind == FaultKind::spikes) needed(reader, table, "probability", "probability, of each value, for spikes");
  fault.probability = reader.number(table, "probability", 1.0, 0.0, 1.0);
  return fault;
}

/// A TOML string.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

}  // namespace

std::vector<farm::Fault> read_faults(const TomlReader& reader, const TomlNode& root) {
  std::vector<Fault> faults;
  for (const TomlNode* table : reader.tables(root, "fault")) faults.push_back(fault_of(reader, *table));
  return faults;
}

std::string faults_text(std::span<const Fault> faults) {
  std::string text;
  for (const Fault& fault : faults) {
    text += fmt::format("[[fault]]\nrobot = {}\nsensor = {}\nkind = \"{}\"\n", quoted(fault.robot),
                        quoted(fmt::format("{}:{}", fault.type, fault.sensor)),
                        base::kFaultNames[static_cast<std::size_t>(fault.kind)]);
    if (!fault.column.empty()) text += fmt::format("column = {}\n", quoted(fault.column));
    if (fault.element) text += fmt::format("element = {}\n", *fault.element);
    const std::string_view key = fault.multiplies ? "factor" : parameter_of(fault.kind).key;
    if (!fault.swapped_columns.empty())
      text += fmt::format("swap = [{}, {}]\n", quoted(fault.swapped_columns[0]), quoted(fault.swapped_columns[1]));
    else if (!fault.swapped_elements.empty())
      text += fmt::format("swap = [{}]\n", fmt::join(fault.swapped_elements, ", "));
    else if (!key.empty())
      text += fmt::format("{} = {}\n", key, fault.amount);
    if (fault.from > 0.0) text += fmt::format("from = {}\n", fault.from);
    if (std::isfinite(fault.until)) text += fmt::format("until = {}\n", fault.until);
    if (fault.probability < 1.0 || fault.kind == FaultKind::spikes)
      text += fmt::format("probability = {}\n", fault.probability);
  }
  return text;
}

std::vector<farm::Fault> parse_faults(const std::string& file, std::string_view text) {
  const TomlReader reader(file);
  const TomlNode root = world::parse_toml(file, text);
  reader.require_known(root, std::array<std::string_view, 1>{"fault"});
  return read_faults(reader, root);
}

std::vector<farm::Fault> recorded_faults(const record::Recording& recording) {
  const std::string text(record::option_of(recording.info, record::kFaultsOption));
  return parse_faults(recording.file + ": faults", text);
}

}  // namespace sf::scenarios
