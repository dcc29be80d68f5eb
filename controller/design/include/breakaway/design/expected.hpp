// Expected: a value, or the reason why there is none.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace breakaway::design {

// What is wrong with an input, for a person: names the parameter, its value and the remedy, in one line.
struct Error {
  std::string message;
};

template <class T>
class [[nodiscard]] Expected {
 public:
  Expected(T value) : value_(std::move(value)) {}
  Expected(Error error) : error_(std::move(error)) {}

  bool has_value() const noexcept { return value_.has_value(); }
  explicit operator bool() const noexcept { return has_value(); }

  // Only when has_value().
  const T& operator*() const noexcept { return *value_; }
  const T* operator->() const noexcept { return &*value_; }
  // Its message is empty when has_value().
  const Error& error() const noexcept { return error_; }

 private:
  std::optional<T> value_;
  Error error_;
};

// The shortest decimal number that reads back as `value`.
std::string to_text(double value);

// The error when `value` is not a finite number above 0.
std::optional<Error> unless_positive(std::string_view name, double value);

// The error when `value` is not a finite number, 0 or above.
std::optional<Error> unless_not_negative(std::string_view name, double value);

}  // namespace breakaway::design
