#include "bridges/foxglove_messages.h"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

namespace sf::bridges {

namespace {

using Json = nlohmann::ordered_json;

/// Replaces invalid UTF-8, since names come from world files and must not end the program.
std::string json_text(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

/// Returns null if the text is not JSON, or is nested more deeply than any message of the protocol.
Json parse(std::string_view text) {
  constexpr int kMaxDepth = 16;
  bool too_deep = false;
  const auto watch = [&](int depth, Json::parse_event_t, Json&) { return !(too_deep = too_deep || depth > kMaxDepth); };
  Json json = Json::parse(text, watch, false);
  return too_deep || json.is_discarded() ? Json() : json;
}

Json time_of(std::int64_t time) { return {{"sec", time / 1'000'000'000}, {"nsec", time % 1'000'000'000}}; }

Json value_of(const Parameter& parameter) {
  if (const bool* const flag = std::get_if<bool>(&parameter.value)) return *flag;
  if (const double* const number = std::get_if<double>(&parameter.value)) return *number;
  if (const std::string* const text = std::get_if<std::string>(&parameter.value)) return *text;
  return nullptr;
}

Json service_side(const Service& service, const char* side, const std::string& fields) {
  return {{"encoding", "cdr"},
          {"schemaName", service.type + "_" + side},
          {"schemaEncoding", "ros2msg"},
          {"schema", fields}};
}

bool read_id(const Json& json, std::uint32_t& id) {
  if (!json.is_number_unsigned() || json.get<std::uint64_t>() > 0xFFFFFFFFu) return false;
  id = json.get<std::uint32_t>();
  return true;
}

std::string string_in(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
}

/// Calls `read` with each element of the list `key`. Returns false if there is no list, or if `read` returns false.
template <class Read>
bool each(const Json& json, const char* key, Read read) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_array()) return false;
  for (const Json& element : *found)
    if (!read(element)) return false;
  return true;
}

bool read_ids(const Json& json, const char* key, ClientText& out) {
  return each(json, key, [&](const Json& id) { return read_id(id, out.ids.emplace_back()); });
}

bool read_names(const Json& json, ClientText& out) {
  return each(json, "parameterNames", [&](const Json& name) {
    if (name.is_string()) out.names.push_back(name.get<std::string>());
    return name.is_string();
  });
}

bool read_subscriptions(const Json& json, ClientText& out) {
  return each(json, "subscriptions", [&](const Json& one) {
    auto& subscription = out.subscriptions.emplace_back();
    return one.is_object() && one.contains("id") && one.contains("channelId") && read_id(one["id"], subscription.id) &&
           read_id(one["channelId"], subscription.channel);
  });
}

bool read_channels(const Json& json, ClientText& out) {
  return each(json, "channels", [&](const Json& one) {
    if (!one.is_object() || !one.contains("id")) return false;
    out.channels.push_back({0, string_in(one, "topic"), string_in(one, "encoding"), string_in(one, "schemaName")});
    return read_id(one["id"], out.channels.back().id);
  });
}

bool read_parameters(const Json& json, ClientText& out) {
  return each(json, "parameters", [&](const Json& one) {
    if (!one.is_object()) return false;
    Parameter parameter{string_in(one, "name"), {}};
    const auto value = one.find("value");
    if (value != one.end() && value->is_boolean()) parameter.value = value->get<bool>();
    if (value != one.end() && value->is_number()) parameter.value = value->get<double>();
    if (value != one.end() && value->is_string()) parameter.value = value->get<std::string>();
    out.parameters.push_back(std::move(parameter));
    return true;
  });
}

struct Operation {
  std::string_view word;
  ClientText::Op op;
  bool (*read)(const Json& json, ClientText& out);
};

bool read_nothing(const Json&, ClientText&) { return true; }

constexpr std::array<Operation, 11> kOperations{{
    {"subscribe", ClientText::Op::subscribe, read_subscriptions},
    {"unsubscribe", ClientText::Op::unsubscribe,
     [](const Json& json, ClientText& out) { return read_ids(json, "subscriptionIds", out); }},
    {"advertise", ClientText::Op::advertise, read_channels},
    {"unadvertise", ClientText::Op::unadvertise,
     [](const Json& json, ClientText& out) { return read_ids(json, "channelIds", out); }},
    {"getParameters", ClientText::Op::get_parameters, read_names},
    {"setParameters", ClientText::Op::set_parameters, read_parameters},
    {"subscribeParameterUpdates", ClientText::Op::subscribe_parameters, read_names},
    {"unsubscribeParameterUpdates", ClientText::Op::unsubscribe_parameters, read_names},
    {"subscribeConnectionGraph", ClientText::Op::other, read_nothing},
    {"unsubscribeConnectionGraph", ClientText::Op::other, read_nothing},
    {"fetchAsset", ClientText::Op::other, read_nothing},
}};

double number_in(const Json& json, const char* group, const char* key) {
  const auto found = json.find(group);
  if (found == json.end() || !found->is_object()) return 0.0;
  const auto value = found->find(key);
  if (value == found->end()) return 0.0;
  return value->is_number() ? value->get<double>() : NAN;
}

}  // namespace

std::string server_info_text(const ServerInfo& info) {
  Json json{{"op", "serverInfo"}, {"name", info.name}, {"capabilities", info.capabilities}};
  json["supportedEncodings"] = {"cdr", "json"};
  json["metadata"] = Json::object();
  for (const auto& [key, value] : info.metadata) json["metadata"][key] = value;
  json["sessionId"] = info.session;
  if (info.start) json["dataStartTime"] = time_of(*info.start);
  if (info.end) json["dataEndTime"] = time_of(*info.end);
  return json_text(json);
}

std::string advertise_text(std::span<const Channel> channels) {
  Json list = Json::array();
  for (const Channel& channel : channels)
    list.push_back({{"id", channel.id},
                    {"topic", channel.topic},
                    {"encoding", "cdr"},
                    {"schemaName", channel.type},
                    {"schemaEncoding", "ros2msg"},
                    {"schema", channel.schema}});
  return json_text({{"op", "advertise"}, {"channels", std::move(list)}});
}

std::string advertise_services_text(std::span<const Service> services) {
  Json list = Json::array();
  for (const Service& service : services)
    list.push_back({{"id", service.id},
                    {"name", service.name},
                    {"type", service.type},
                    {"request", service_side(service, "Request", service.request)},
                    {"response", service_side(service, "Response", service.response)},
                    {"requestSchema", service.request},
                    {"responseSchema", service.response}});
  return json_text({{"op", "advertiseServices"}, {"services", std::move(list)}});
}

std::string parameters_text(std::span<const Parameter> parameters, std::string_view id) {
  Json list = Json::array();
  for (const Parameter& parameter : parameters) {
    Json one{{"name", parameter.name}, {"value", value_of(parameter)}};
    if (std::holds_alternative<double>(parameter.value)) one["type"] = "float64";
    list.push_back(std::move(one));
  }
  Json json{{"op", "parameterValues"}, {"parameters", std::move(list)}};
  if (!id.empty()) json["id"] = id;
  return json_text(json);
}

std::string status_text(StatusLevel level, std::string_view message) {
  return json_text({{"op", "status"}, {"level", static_cast<int>(level)}, {"message", message}});
}

std::string service_failure_text(std::uint32_t service, std::uint32_t call, std::string_view message) {
  return json_text({{"op", "serviceCallFailure"}, {"serviceId", service}, {"callId", call}, {"message", message}});
}

std::optional<ClientText> parse_client_text(std::string_view text) {
  const Json json = parse(text);
  if (!json.is_object()) return std::nullopt;
  const std::string word = string_in(json, "op");
  for (const Operation& operation : kOperations) {
    if (operation.word != word) continue;
    ClientText message;
    message.op = operation.op;
    message.id = string_in(json, "id");
    if (!operation.read(json, message)) return std::nullopt;
    return message;
  }
  return std::nullopt;
}

std::optional<base::Twist> parse_json_twist(std::string_view text) {
  Json json = parse(text);
  if (json.is_object() && json.contains("twist")) json = Json(json["twist"]);
  if (!json.is_object()) return std::nullopt;
  return base::Twist{number_in(json, "linear", "x"), number_in(json, "linear", "y"), number_in(json, "angular", "z")};
}

std::optional<bool> parse_json_bool(std::string_view text) {
  const Json json = parse(text);
  if (!json.is_object() || !json.contains("data") || !json["data"].is_boolean()) return std::nullopt;
  return json["data"].get<bool>();
}

std::string json_response(bool success, std::string_view message) {
  return json_text({{"success", success}, {"message", message}});
}

}  // namespace sf::bridges
