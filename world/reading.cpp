#include "world/reading.h"

#include <fmt/format.h>

#include "base/error.h"

namespace sf::world {

void fail(const Reading& r, int line, const std::string& message) {
  throw base::InputError(r.document.files[r.file], line, message);
}

void warn(Reading& r, int line, std::string message) {
  r.document.warnings.push_back({r.document.files[r.file], line, std::move(message)});
}

std::string shown(const Token& token) {
  if (token.kind == TokenKind::end) return "the end of the file";
  return token.kind == TokenKind::text ? '"' + token.text + '"' : '\'' + token.text + '\'';
}

namespace {

Value value_of(const Token& token) { return {token.kind == TokenKind::text, token.number, token.text}; }

bool is_value(const Token& token) { return token.kind == TokenKind::number || token.kind == TokenKind::text; }

void read_tuple(Reading& r, Property& property) {
  const int line = now(r).line;
  property.is_tuple = true;
  for (++r.at; now(r).kind != TokenKind::close_tuple; ++r.at) {
    if (now(r).kind == TokenKind::end) fail(r, line, "this '[' is never closed; expected ']'");
    if (!is_value(now(r))) {
      fail(r, now(r).line,
           fmt::format("expected a number, a \"string\" or ']' in the tuple of '{}', found {}", property.key,
                       shown(now(r))));
    }
    property.values.push_back(value_of(now(r)));
  }
  ++r.at;
}

}  // namespace

Property read_property(Reading& r) {
  Property property{now(r).text, {}, false, place(r, now(r))};
  const int line = now(r).line;
  ++r.at;
  if (now(r).kind == TokenKind::open_tuple) {
    read_tuple(r, property);
  } else if (is_value(now(r))) {
    property.values.push_back(value_of(now(r)));
    ++r.at;
  } else {
    fail(r, line,
         fmt::format("'{}' needs a value (a number, a \"string\" or a [tuple]) or a body in parentheses; found {}",
                     property.key, shown(now(r))));
  }
  return property;
}

void add_property(Reading& r, Entity& entity, std::unordered_set<std::string>& written, Property property) {
  if (!written.insert(property.key).second) {
    if (property.key.find('[') != std::string::npos) {
      fail(r, property.at.line,
           fmt::format("'{}' is given twice in the same '{}'; number them one by one: [0], [1], [2] ...", property.key,
                       entity.word));
    }
    warn(r, property.at.line, fmt::format("'{}' is given twice; the last one counts", property.key));
  }
  const auto same = [&](const Property& p) { return p.key == property.key; };
  const auto old = std::find_if(entity.properties.begin(), entity.properties.end(), same);
  const auto weight = static_cast<std::uint32_t>(1 + property.values.size());
  entity.weight += weight;
  r.weight += weight;
  if (old != entity.properties.end()) {
    *old = std::move(property);
  } else {
    entity.properties.push_back(std::move(property));
  }
}

}  // namespace sf::world
