#include "breakaway/watch/datagram.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "breakaway/input/input_error.hpp"

namespace breakaway::watch {
namespace {

using Json = nlohmann::json;

constexpr const char* remedy = "the stream is for breakaway-node --stream";

// The fields of the axis are those behind the last slash of their names; the others are the node's.
class Fields {
 public:
  explicit Fields(std::string_view text) : object_(Json::parse(text, nullptr, false)) {
    if (!object_.is_object()) throw InputError{fmt::format("a datagram is no JSON object; {}", remedy)};
    constexpr std::string_view known = "/position_m";
    for (const auto& [name, value] : object_.items()) {
      if (!value.is_number())
        throw InputError{fmt::format("a datagram has a field that is no number, {}; {}", shown(name), remedy)};
      if (name.ends_with(known)) axis_ = name.substr(0, name.size() - known.size());
    }
  }

  const std::string& axis() const { return axis_; }
  double node_real(const std::string& name) const { return real_of(name); }
  double axis_real(const std::string& name) const { return real_of(prefixed(name)); }
  // An enumerator's number; none where the field is missing.
  std::int64_t axis_number(const std::string& name) const { return integer_of(prefixed(name), -1); }
  std::int64_t axis_integer(const std::string& name) const { return integer_of(prefixed(name), 0); }
  std::uint64_t count(const std::string& name) const {
    return static_cast<std::uint64_t>(std::max<std::int64_t>(integer_of(name, 0), 0));
  }

 private:
  // A name from the network is shortened before it is shown.
  static std::string shown(const std::string& name) {
    constexpr std::size_t longest = 32;
    std::string text = name.substr(0, longest);
    for (char& c : text)
      if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7E) c = '?';
    return text;
  }
  std::string prefixed(const std::string& name) const { return axis_.empty() ? name : axis_ + "/" + name; }
  double real_of(const std::string& name) const {
    const auto found = object_.find(name);
    return found == object_.end() ? unknown : found->get<double>();
  }
  std::int64_t integer_of(const std::string& name, std::int64_t otherwise) const {
    const auto found = object_.find(name);
    return found != object_.end() && found->is_number_integer() ? found->get<std::int64_t>() : otherwise;
  }

  Json object_;
  std::string axis_;
};

}  // namespace

Datagram read_datagram(std::string_view text) {
  const Fields fields{text};
  constexpr std::size_t longest_name = 64;
  Datagram read{.sample = {.axis = fields.axis(),
                           .time_s = fields.node_real("timestamp"),
                           .target_m = fields.axis_real("target_m"),
                           .position_m = fields.axis_real("position_m"),
                           .command_N = fields.axis_real("command_N"),
                           .reported_N = fields.axis_real("reported_N"),
                           .latency_us = fields.node_real("latency_us"),
                           .bus_load = fields.node_real("bus_load"),
                           .mode = enumerator<law::Mode>(fields.axis_number("mode")),
                           .drive = enumerator<hal::DriveState>(fields.axis_number("drive")),
                           .fault = enumerator<firmware::AxisFault>(fields.axis_number("fault")),
                           .fault_code = static_cast<std::uint16_t>(fields.axis_integer("fault_code") & 0xFFFF),
                           .stop_not_obeyed = fields.axis_integer("stop_not_obeyed") > 0,
                           .link_lost = fields.axis_integer("link_lost") > 0},
                .number = fields.count("sample"),
                .dropped = fields.count("dropped")};
  if (!std::isfinite(read.sample.time_s) || !std::isfinite(read.sample.position_m) ||
      read.sample.axis.size() > longest_name)
    throw InputError{fmt::format("a datagram has no timestamp or no position_m; {}", remedy)};
  return read;
}

}  // namespace breakaway::watch
