// DoubleDouble: the unevaluated sum of two doubles, which carries 31 decimal digits over double's range of exponents.
//
// Factorisations of machines whose masses or springs differ by 1e12 lose up to 24 digits, more than long double has.
// This type runs some 20 times slower than double and several times faster than the 113-bit numbers that a compiler
// emulates. Sums and products are those of Dekker (1971) and Knuth; they hold without contraction of any kind.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>

namespace breakaway::stability {

class DoubleDouble {
 public:
  DoubleDouble() = default;
  DoubleDouble(double value) : high_{value} {}                             // NOLINT(google-explicit-constructor): exact
  DoubleDouble(int value) : high_{static_cast<double>(value)} {}           // NOLINT(google-explicit-constructor): exact
  DoubleDouble(Eigen::Index value) : high_{static_cast<double>(value)} {}  // NOLINT(google-explicit-constructor)
  explicit DoubleDouble(long double value)
      : high_{static_cast<double>(value)}, low_{static_cast<double>(value - high_)} {}

  double high() const { return high_; }
  double low() const { return low_; }
  explicit operator double() const { return high_; }
  explicit operator long double() const { return static_cast<long double>(high_) + low_; }
  explicit operator int() const { return static_cast<int>(high_); }

  DoubleDouble operator-() const { return {-high_, -low_}; }

  friend DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
    DoubleDouble sum = two_sum(a.high_, b.high_);
    const DoubleDouble rest = two_sum(a.low_, b.low_);
    sum = fast_two_sum(sum.high_, sum.low_ + rest.high_);
    return fast_two_sum(sum.high_, sum.low_ + rest.low_);
  }
  friend DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) { return a + -b; }
  friend DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
    const DoubleDouble product = two_product(a.high_, b.high_);
    return fast_two_sum(product.high_, product.low_ + (a.high_ * b.low_ + a.low_ * b.high_));
  }
  friend DoubleDouble operator/(const DoubleDouble& a, const DoubleDouble& b) {
    const double first = a.high_ / b.high_;
    DoubleDouble rest = a - b * first;
    const double second = rest.high_ / b.high_;
    rest = rest - b * second;
    return fast_two_sum(first, second) + rest.high_ / b.high_;
  }
  DoubleDouble& operator+=(const DoubleDouble& b) { return *this = *this + b; }
  DoubleDouble& operator-=(const DoubleDouble& b) { return *this = *this - b; }
  DoubleDouble& operator*=(const DoubleDouble& b) { return *this = *this * b; }
  DoubleDouble& operator/=(const DoubleDouble& b) { return *this = *this / b; }

  friend bool operator==(const DoubleDouble& a, const DoubleDouble& b) {
    return a.high_ == b.high_ && a.low_ == b.low_;
  }
  friend bool operator<(const DoubleDouble& a, const DoubleDouble& b) {
    return a.high_ < b.high_ || (a.high_ == b.high_ && a.low_ < b.low_);
  }
  friend bool operator>(const DoubleDouble& a, const DoubleDouble& b) { return b < a; }
  friend bool operator<=(const DoubleDouble& a, const DoubleDouble& b) { return a < b || a == b; }
  friend bool operator>=(const DoubleDouble& a, const DoubleDouble& b) { return b <= a; }

  friend DoubleDouble abs(const DoubleDouble& a) { return a.high_ < 0 ? -a : a; }
  friend DoubleDouble fabs(const DoubleDouble& a) { return abs(a); }
  friend DoubleDouble sqrt(const DoubleDouble& a) {
    const double root = std::sqrt(a.high_);
    if (root == 0 || !std::isfinite(root)) return root;
    return root + (a - two_product(root, root)) / (2 * root);  // one step of Newton's method doubles the digits
  }
  friend bool isfinite(const DoubleDouble& a) { return std::isfinite(a.high_); }
  friend bool isnan(const DoubleDouble& a) { return std::isnan(a.high_); }
  friend bool isinf(const DoubleDouble& a) { return std::isinf(a.high_); }

 private:
  DoubleDouble(double high, double low) : high_{high}, low_{low} {}

  // high + low = a + b exactly, for |a| >= |b|, and for any a and b.
  static DoubleDouble fast_two_sum(double a, double b) {
    const double sum = a + b;
    return {sum, b - (sum - a)};
  }
  static DoubleDouble two_sum(double a, double b) {
    const double sum = a + b, shown = sum - a;
    return {sum, (a - (sum - shown)) + (b - shown)};
  }
  // high + low = a b exactly, unless the low half underflows.
  static DoubleDouble two_product(double a, double b) {
    const double product = a * b;
#ifdef __FP_FAST_FMA
    return {product, std::fma(a, b, -product)};
#else
    const DoubleDouble x = halves(a), y = halves(b);
    return {product, ((x.high_ * y.high_ - product) + x.high_ * y.low_ + x.low_ * y.high_) + x.low_ * y.low_};
#endif
  }
  // Veltkamp's halves of 26 bits.
  static DoubleDouble halves(double a) {
    const double shifted = 134217729.0 * a, high = shifted - (shifted - a);
    return {high, a - high};
  }

  double high_ = 0;
  double low_ = 0;
};

}  // namespace breakaway::stability

/** @cond */
template <>
class std::numeric_limits<breakaway::stability::DoubleDouble> : public std::numeric_limits<double> {
 public:
  static constexpr int digits = 104;
  static constexpr int digits10 = 31;
  static breakaway::stability::DoubleDouble min() { return std::numeric_limits<double>::min(); }
  static breakaway::stability::DoubleDouble max() { return std::numeric_limits<double>::max(); }
  static breakaway::stability::DoubleDouble lowest() { return std::numeric_limits<double>::lowest(); }
  static breakaway::stability::DoubleDouble epsilon() { return 0x1p-104; }
};

template <>
struct Eigen::NumTraits<breakaway::stability::DoubleDouble>
    : Eigen::GenericNumTraits<breakaway::stability::DoubleDouble> {
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = 2,
    AddCost = 20,
    MulCost = 25
  };
  static breakaway::stability::DoubleDouble dummy_precision() { return 1e-28; }
  static int digits10() { return 31; }
};
/** @endcond */
