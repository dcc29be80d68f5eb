// The settings of a long run, which come from environment variables.
#pragma once

#include <cstdlib>
#include <string>

namespace breakaway::campaign {

inline long from_environment(const char* name, long fallback) {
  const char* const text = std::getenv(name);
  return text == nullptr ? fallback : std::strtol(text, nullptr, 10);
}

inline bool set_in_environment(const char* name) { return std::getenv(name) != nullptr; }

inline double number_from_environment(const char* name, double fallback) {
  const char* const text = std::getenv(name);
  return text == nullptr ? fallback : std::strtod(text, nullptr);
}

// Empty where the variable is not set.
inline std::string text_from_environment(const char* name) {
  const char* const text = std::getenv(name);
  return text == nullptr ? "" : text;
}

}  // namespace breakaway::campaign
