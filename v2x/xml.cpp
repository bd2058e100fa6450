#include "v2x/xml.h"

#include <fmt/format.h>

#include "v2x/map_fields.h"
#include "v2x/spat_fields.h"
#include "v2x/text_forms.h"

namespace sf::v2x {

namespace {

/// X.693 encodes control characters as elements.
constexpr std::array<std::string_view, 32> kControls{
    "nul", "soh", "stx", "etx", "eot", "enq", "ack", "bel", "bs",  "tab", "lf",  "vt",  "ff",  "cr",  "so",  "si",
    "dle", "dc1", "dc2", "dc3", "dc4", "nak", "syn", "etb", "can", "em",  "sub", "esc", "is4", "is3", "is2", "is1"};

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else if (static_cast<unsigned char>(c) < 32) {
      out += fmt::format("<{}/>", kControls[static_cast<std::size_t>(c)]);
    } else {
      out += c;
    }
  }
  return out;
}

/// Writes the lines of one message. One-line values are placed between their tags; all others have their own lines.
class Writer {
 public:
  explicit Writer(unsigned depth) : depth_(depth) {}

  template <class T, class Type>
  void operator()(std::string_view name, const T& value, const Type& type) {
    if constexpr (requires { text(value, type); }) {
      line(fmt::format("<{0}>{1}</{0}>", name, text(value, type)));
    } else {
      element(name, [&] { content(value, type); });
    }
  }
  template <class T, class Type>
  void optional(std::string_view name, const T& value, const Type& type) {
    if (is_present(value)) (*this)(name, engage(value), type);
  }
  template <class Inner>
  void element(std::string_view name, Inner&& inner) {
    line(fmt::format("<{}>", name));
    ++depth_;
    inner();
    --depth_;
    line(fmt::format("</{}>", name));
  }
  void frame(const Frame& frame) {
    element("MessageFrame", [&] {
      std::visit(
          [&](const auto& message) {
            line(fmt::format("<messageId>{}</messageId>", message.kMessageId));
            element("value", [&] { (*this)(message.kTag, message, Described{}); });
          },
          frame.message);
      content(frame.additions);
    });
  }
  std::string take() { return std::move(lines_); }

 private:
  void line(std::string_view text) { lines_ += fmt::format("{:{}}{}\n", "", 2 * depth_, text); }

  // One-line values.
  template <class T>
  static std::string text(const T& value, const Whole&) {
    return fmt::format("{}", value);
  }
  template <class T>
  static std::string text(const T& value, const BitString& type) {
    return bits_text(value, type.size);
  }
  static std::string text(const ExtensibleBits& value, const BitString&) { return bits_text(value.bits, value.size); }
  static std::string text(const std::string& value, const Text&) { return escaped(value); }
  static std::string text(const base::Bytes& value, const Octets&) { return hex_text(value); }

  // Multi-line values.
  template <class T>
  void content(const T& value, const Named& type) {
    line(fmt::format("<{}/>", row_text(type.names, row_of(value))));
  }
  void content(const bool& value, const Flag&) { line(value ? "<true/>" : "<false/>"); }
  template <class T>
  void content(const T& value, const Described&) {
    if constexpr (ExtensibleChoice<T>) {
      if (row_of(value.choice) >= value.kAlternatives.size())
        return (*this)(row_text(value.kAlternatives, row_of(value.choice)), value.unknown, Octets{});
    }
    if constexpr (Choice<T>) {
      alternative(value, [&](const auto& inner, const auto& type) {
        (*this)(value.kAlternatives[row_of(value.choice)], inner, type);
      });
    } else {
      fields(value, *this);
    }
    if constexpr (ExtensibleSequence<T>) content(value.additions);
  }
  template <class T, class Item>
  void content(const std::vector<T>& list, const ListOf<Item>& type) {
    for (const T& item : list) {
      if constexpr (Choice<T> || std::same_as<Item, Named>) {
        content(item, type.item);
      } else {
        (*this)(type.element, item, type.item);
      }
    }
  }
  void content(const Additions& additions) {
    for (std::size_t i = 0; i < additions.values.size(); ++i)
      if (additions.values[i]) (*this)(fmt::format("extension-{}", i), *additions.values[i], Octets{});
  }

  std::string lines_;
  unsigned depth_;
};

}  // namespace

std::string xml_of(const Frame& frame, unsigned depth) {
  Writer writer(depth);
  writer.frame(frame);
  return writer.take();
}

}  // namespace sf::v2x
