#include "breakaway/watch/command.hpp"

#include <nlohmann/json.hpp>
#include <string>

namespace breakaway::watch {
namespace {

using Json = nlohmann::json;

std::optional<Action> read_action(const std::string& name) {
  if (name == "enable") return Action::enable;
  if (name == "stop") return Action::stop;
  if (name == "target") return Action::target;
  if (name == "reset") return Action::reset;
  return {};
}

}  // namespace

std::optional<Command> read_command(std::string_view body) {
  const Json object = Json::parse(body, nullptr, false);
  if (!object.is_object() || !object.contains("axis") || !object["axis"].is_number_unsigned() ||
      !object.contains("action") || !object["action"].is_string())
    return {};
  const auto action = read_action(object["action"].get<std::string>());
  if (!action) return {};
  Command command{.axis = object["axis"].get<std::size_t>(), .action = *action};
  if (*action != Action::target) return command;
  if (!object.contains("target_m") || !object["target_m"].is_number()) return {};
  command.target_m = object["target_m"].get<double>();
  return command;
}

}  // namespace breakaway::watch
