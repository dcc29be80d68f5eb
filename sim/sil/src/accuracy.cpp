#include "breakaway/sil/accuracy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace breakaway::sil {
namespace {

std::string refusal_text(double asked_m, const std::vector<MethodRefusal>& refused) {
  std::string text = fmt::format("no method holds accuracy_m = {:g}", asked_m);
  const char* separator = ": ";
  for (const MethodRefusal& refusal : refused) {
    text += fmt::format("{}{} {}", separator, scenario::to_string(refusal.method.integrator), refusal.reason);
    if (std::isfinite(refusal.cost_s)) text += fmt::format(", {}", cost_text(refusal.cost_s));
    separator = "; ";
  }
  const bool some_follow = std::ranges::any_of(refused, &MethodRefusal::follows);
  return text + (some_follow ? "; ask for less" : "; mend the cause that they name, or shorten [run] duration_s");
}

}  // namespace

std::string to_string(const Method& method) {
  std::string name = scenario::to_string(method.integrator);
  if (method.step_s > 0) return fmt::format("{} with a step of {:.3g} s", name, method.step_s);
  if (method.tolerance > 0) return fmt::format("{} with a tolerance of {:g}", name, method.tolerance);
  return name;
}

std::string cost_text(double cost_s) {
  struct Unit {
    double limit_s, size_s;
    const char* name;
  };
  for (const Unit& unit : {Unit{1e-3, 1e-6, "us"}, Unit{1, 1e-3, "ms"}, Unit{100, 1, "s"}, Unit{6000, 60, "minutes"}}) {
    if (cost_s < unit.limit_s) return fmt::format("about {:.3g} {}", cost_s / unit.size_s, unit.name);
  }
  return fmt::format("about {:.3g} hours", cost_s / 3600);
}

AccuracyRefused::AccuracyRefused(const std::string& file, double asked_m, std::vector<MethodRefusal> refused)
    : InputError{InputError{refusal_text(asked_m, refused)}.in_file(file)},
      asked_m_{asked_m},
      refused_{std::move(refused)} {}

}  // namespace breakaway::sil
