// The switches of the mutants: every file of a mutated copy is compiled with this included first; see README.md.
//
// BREAKAWAY_MUTANT says in the environment which fault is in: a number puts that mutant in, "trace" puts none in and
// notes which mutants would have made a difference, nothing leaves the code as it stands. What a compiler evaluates
// is never mutated, so that constexpr functions stay what they are.
#pragma once

#if __cplusplus >= 202002L  // else CMake tries the compiler

#include <sys/mman.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <type_traits>
#include <utility>

namespace mutation {

inline constexpr int most_mutants = 1 << 17;
inline constexpr int tracing = -1;

inline int selected_by_environment() noexcept {
  const char* const wish = std::getenv("BREAKAWAY_MUTANT");
  if (wish == nullptr) return 0;
  return std::strcmp(wish, "trace") == 0 ? tracing : std::atoi(wish);
}

// Shared with child processes, so that what a death test reaches counts.
inline unsigned char* shared_marks() noexcept {
  void* const memory = mmap(nullptr, most_mutants, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  return memory == MAP_FAILED ? nullptr : static_cast<unsigned char*>(memory);
}

inline int selected = selected_by_environment();
inline unsigned char* marks = selected == tracing ? shared_marks() : nullptr;

inline void mark(int id) noexcept {
  if (marks != nullptr) marks[id] = 1;
}

// Whether this mutant is in; the trace notes that it was asked for.
constexpr bool on(int id) noexcept {
  if (std::is_constant_evaluated() || selected == 0) return false;
  if (selected == tracing) mark(id);
  return selected == id;
}

template <class T>
constexpr bool differ(const T& a, const T& b) noexcept {
  if constexpr (requires {
                  a.size();
                  a.rows();
                })
    return a.rows() != b.rows() || a.cols() != b.cols() || !(a.array() == b.array()).all();
  else if constexpr (requires { static_cast<bool>(a == b); })
    return !static_cast<bool>(a == b);
  return true;
}

// `value`, or what `other` returns where the mutant is in. The trace notes it where the two differ.
template <class T, class Other>
constexpr T either(int id, T value, Other other) {
  if (std::is_constant_evaluated() || selected == 0) return value;
  if (selected == tracing) {
    if (differ(value, static_cast<T>(other()))) mark(id);
    return value;
  }
  return selected == id ? static_cast<T>(other()) : value;
}

#define BREAKAWAY_MUTATION_RELATION(name, op, shifted)                       \
  template <class A, class B>                                                \
  constexpr bool name(int boundary, int negation, const A& a, const B& b) {  \
    const bool value = static_cast<bool>(a op b);                            \
    if (std::is_constant_evaluated() || selected == 0) return value;         \
    return either(boundary, either(negation, value, [&] { return !value; }), \
                  [&] { return static_cast<bool>(a shifted b); });           \
  }
BREAKAWAY_MUTATION_RELATION(less, <, <=)
BREAKAWAY_MUTATION_RELATION(less_equal, <=, <)
BREAKAWAY_MUTATION_RELATION(greater, >, >=)
BREAKAWAY_MUTATION_RELATION(greater_equal, >=, >)
#undef BREAKAWAY_MUTATION_RELATION

template <class T>
constexpr bool negated(int id, T&& value) {
  const bool is = static_cast<bool>(std::forward<T>(value));
  return either(id, is, [is] { return !is; });
}

// Eigen's operators return expressions that refer to their operands: here they are evaluated at once.
template <class T>
concept Expression = requires {
  typename T::PlainObject;
};

template <class T>
constexpr auto evaluated(const T& value) {
  if constexpr (Expression<T>)
    return typename T::PlainObject{value};
  else
    return value;
}

// The other operation's value, or a default one where there is none between these types: of a vector or a matrix
// zeros of its size. An integer divisor of zero counts as one: a processor's trap would say nothing of a test.
#define BREAKAWAY_MUTATION_ARITHMETIC(name, op, other)                                      \
  template <class A, class B>                                                               \
  constexpr auto name(int id, const A& a, const B& b) {                                     \
    auto value = evaluated(a op b);                                                         \
    using Result = decltype(value);                                                         \
    return either(id, value, [&]() -> Result {                                              \
      const char sign[] = #other;                                                           \
      if constexpr (std::is_integral_v<B>) {                                                \
        if (sign[0] == '/' && b == B{0}) return Result{};                                   \
      }                                                                                     \
      constexpr bool between_vectors = Expression<A> && Expression<B>;                      \
      constexpr bool product = sizeof(sign) == 2 && (#other[0] == '*' || #other[0] == '/'); \
      if constexpr (Expression<Result> && (between_vectors ? product : !Expression<A>))     \
        return Result::Zero(value.rows(), value.cols());                                    \
      else if constexpr (requires { static_cast<Result>(a other b); })                      \
        return static_cast<Result>(a other b);                                              \
      else                                                                                  \
        return Result{};                                                                    \
    });                                                                                     \
  }
BREAKAWAY_MUTATION_ARITHMETIC(add, +, -)
BREAKAWAY_MUTATION_ARITHMETIC(subtract, -, +)
BREAKAWAY_MUTATION_ARITHMETIC(multiply, *, /)
BREAKAWAY_MUTATION_ARITHMETIC(divide, /, *)
BREAKAWAY_MUTATION_ARITHMETIC(modulo, %, *)
BREAKAWAY_MUTATION_ARITHMETIC(bit_and, &, |)
BREAKAWAY_MUTATION_ARITHMETIC(bit_or, |, &)
BREAKAWAY_MUTATION_ARITHMETIC(bit_xor, ^, |)
BREAKAWAY_MUTATION_ARITHMETIC(shift_left, <<, >>)
BREAKAWAY_MUTATION_ARITHMETIC(shift_right, >>, <<)
#undef BREAKAWAY_MUTATION_ARITHMETIC

#define BREAKAWAY_MUTATION_ASSIGNMENT(name, op, other)       \
  template <class A, class B>                                \
  constexpr decltype(auto) name(int id, A&& a, const B& b) { \
    if (on(id)) return a other b;                            \
    return a op b;                                           \
  }
BREAKAWAY_MUTATION_ASSIGNMENT(add_to, +=, -=)
BREAKAWAY_MUTATION_ASSIGNMENT(subtract_from, -=, +=)
BREAKAWAY_MUTATION_ASSIGNMENT(multiply_by, *=, /=)
BREAKAWAY_MUTATION_ASSIGNMENT(divide_by, /=, *=)
BREAKAWAY_MUTATION_ASSIGNMENT(and_with, &=, |=)
BREAKAWAY_MUTATION_ASSIGNMENT(or_with, |=, &=)
BREAKAWAY_MUTATION_ASSIGNMENT(xor_with, ^=, |=)
BREAKAWAY_MUTATION_ASSIGNMENT(shift_left_by, <<=, >>=)
BREAKAWAY_MUTATION_ASSIGNMENT(shift_right_by, >>=, <<=)
#undef BREAKAWAY_MUTATION_ASSIGNMENT

template <class A>
constexpr A& increment(int id, A& a) {
  return on(id) ? --a : ++a;
}
template <class A>
constexpr A& decrement(int id, A& a) {
  return on(id) ? ++a : --a;
}

template <class A>
constexpr auto minus(int id, const A& a) {
  const auto value = -a;
  return either(id, value, [&] { return static_cast<decltype(-a)>(a); });
}
template <class A>
constexpr auto complement(int id, const A& a) {
  const auto value = ~a;
  return either(id, value, [&] { return static_cast<decltype(~a)>(a); });
}

template <class T>
struct IsDuration : std::false_type {};
template <class Count, class Period>
struct IsDuration<std::chrono::duration<Count, Period>> : std::true_type {};

// A constant that is off: one for zero and for infinity, zero for one, one more of an integer, twice a fraction, ten
// times a time.
template <class T>
constexpr T constant(int id, T value) {
  return either(id, value, [value]() -> T {
    if constexpr (std::is_same_v<T, bool>)
      return !value;
    else if constexpr (std::is_floating_point_v<T>)
      return value == T{0} || std::isinf(value) ? T{1} : value * T{2};
    else if constexpr (std::is_integral_v<T>)
      return value == T{1} ? T{0} : static_cast<T>(value + 1);
    else if constexpr (IsDuration<T>::value)
      return value == T{} ? T{1} : value * 10;
    else
      return T{};
  });
}

// Another value than the one that is returned.
template <class T>
constexpr std::remove_cvref_t<T> returned(int id, T&& value) {
  using Value = std::remove_cvref_t<T>;
  if (!on(id)) return std::forward<T>(value);
  if constexpr (std::is_same_v<Value, bool>)
    return !value;
  else if constexpr (std::is_arithmetic_v<Value>)
    return value == Value{0} ? Value{1} : Value{0};
  else if constexpr (std::is_enum_v<Value>)
    return value == Value{} ? static_cast<Value>(1) : Value{};
  else if constexpr (std::is_default_constructible_v<Value>)
    return Value{};
  else
    __builtin_trap();
}
template <std::size_t N>
constexpr const char* returned(int id, const char (&value)[N]) {
  return on(id) ? "" : value;
}

template <class T>
constexpr T least(int id, const T& a, const T& b) {
  return either(id, std::min<T>(a, b), [&] { return std::max<T>(a, b); });
}
template <class T>
constexpr T greatest(int id, const T& a, const T& b) {
  return either(id, std::max<T>(a, b), [&] { return std::min<T>(a, b); });
}
template <class T>
constexpr T clamped(int open_below, int open_above, const T& value, const T& low, const T& high) {
  return either(open_below,
                either(open_above, std::clamp<T>(value, low, high), [&] { return std::max<T>(value, low); }),
                [&] { return std::min<T>(value, high); });
}
template <class T>
constexpr auto magnitude(int id, const T& value) {
  return either(id, std::abs(value), [&] { return value; });
}

}  // namespace mutation

#endif
