// The law through its C interface: the same bits as the class, and an answer to every wrong image.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <type_traits>
#include <vector>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/flash.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/firmware/law_image.hpp"
#include "breakaway/law.h"
#include "breakaway/law/axis_controller.hpp"

namespace breakaway {
namespace {

using Image = std::vector<std::uint8_t>;

config::Node scene(const std::string& name) {
  return config::read_node(BREAKAWAY_SOURCE_DIR "/sim/scenarios/" + name + ".toml");
}
Image image_of(const std::string& name) {
  const config::Node node = scene(name);
  const auto reports = config::examine(node);
  if (config::is_by_work(node)) return config::law_image(config::certified_by_work(node, reports));
  return config::law_image(config::certified(node, reports));
}

int init(breakaway_law_f& law, const Image& image, unsigned axis = 0) {
  return breakaway_law_f_init(&law, sizeof law, BREAKAWAY_LAW_ABI, image.data(), image.size(), axis);
}
int init(breakaway_law_d& law, const Image& image, unsigned axis = 0) {
  return breakaway_law_d_init(&law, sizeof law, BREAKAWAY_LAW_ABI, image.data(), image.size(), axis);
}
float update(breakaway_law_f& law, float position_m, bool fresh) {
  return breakaway_law_f_update(&law, position_m, fresh);
}
double update(breakaway_law_d& law, double position_m, bool fresh) {
  return breakaway_law_d_update(&law, position_m, fresh);
}
int set_target(breakaway_law_f& law, float target_m) { return breakaway_law_f_set_target(&law, target_m); }
int set_target(breakaway_law_d& law, double target_m) { return breakaway_law_d_set_target(&law, target_m); }
int reset(breakaway_law_f& law) { return breakaway_law_f_reset(&law); }
int reset(breakaway_law_d& law) { return breakaway_law_d_reset(&law); }
breakaway_law_status status(const breakaway_law_f& law) {
  breakaway_law_status s{};
  EXPECT_EQ(breakaway_law_f_status(&law, &s), BREAKAWAY_OK);
  return s;
}
breakaway_law_status status(const breakaway_law_d& law) {
  breakaway_law_status s{};
  EXPECT_EQ(breakaway_law_d_status(&law, &s), BREAKAWAY_OK);
  return s;
}

// Both laws see one axis that follows the force roughly: what it does matters less than that everything happens.
template <class Real, class Kicks, class Law>
void expect_equal_bits(law::AxisController<Real, Kicks>& cpp, Law& c, std::uint64_t seed) {
  std::mt19937_64 bits{seed};
  const auto share = [&] { return std::uniform_real_distribution<>{0, 1}(bits); };
  double x = -0.02 * share(), v = 0, acting_N = 0;
  Real target_m = 0;
  int faults = 0;
  long kicks = 0;
  for (int period = 0; period < 4000; ++period) {
    const double friction_N = 3 + share();
    if (v == 0 && std::fabs(acting_N) <= friction_N) {
      acting_N = 0;
    } else {
      const double along = v != 0 ? std::copysign(1.0, v) : std::copysign(1.0, acting_N);
      const double next = v + (acting_N - along * friction_N) * 1e-3;
      v = v != 0 && next * v < 0 ? 0 : next;
    }
    x += v * 1e-3;
    const bool fresh = share() > 0.01;
    const Real read = static_cast<Real>(std::floor(x / 1e-6) * 1e-6) + (share() < 2e-4 ? Real(NAN) : Real(0));
    const auto out = cpp.update({read - target_m, Real(0), fresh});
    const Real force_N = update(c, read, fresh);
    ASSERT_EQ(std::memcmp(&out.force_N, &force_N, sizeof force_N), 0) << period << ": " << out.force_N;
    const auto s = status(c);
    ASSERT_EQ(s.mode, static_cast<int>(out.mode));
    ASSERT_EQ(s.kicks, cpp.kicks());
    ASSERT_EQ(s.fault, static_cast<int>(cpp.fault()));
    ASSERT_LE(std::fabs(static_cast<double>(force_N)), s.max_force_N);
    acting_N = static_cast<double>(force_N);
    kicks += out.kicked;
    if (s.fault != 0 && share() < 0.1) {
      ++faults;
      cpp.reset();
      EXPECT_EQ(reset(c), BREAKAWAY_OK);
    }
    if (share() < 1e-3) {
      const Real next = static_cast<Real>(x + 0.01 * (share() - 0.5));
      cpp.shift_target(next - target_m);
      target_m = next;
      EXPECT_EQ(set_target(c, target_m), BREAKAWAY_OK);
    }
  }
  EXPECT_GT(kicks, 0);
}

// Puts the numbers of one axis, in their order, into one of another scalar type.
struct NumbersOut {
  std::vector<double> numbers;  // each fits a double

  template <class T>
  void value(const char*, const T& number, const char* = "") {
    if constexpr (!std::is_same_v<T, firmware::AxisName>) numbers.push_back(static_cast<double>(number));
  }
  template <class Body>
  void group(const char*, const Body& body) {
    body();
  }
  template <class Items, class Body>
  void list(const char*, Items&& items, const Body& body) {
    for (auto& item : items) body(item);
  }
  template <class Items>
  void row(const char*, Items&& items) {
    for (auto& item : items) value("", item);
  }
};
struct NumbersIn {
  std::vector<double> numbers;
  std::size_t next = 0;

  template <class T>
  void value(const char*, T& number, const char* = "") {
    if constexpr (std::is_same_v<T, bool>)
      number = numbers[next++] > 0;
    else if constexpr (std::is_enum_v<T>)
      number = static_cast<T>(static_cast<int>(numbers[next++]));
    else if constexpr (!std::is_same_v<T, firmware::AxisName>)
      number = static_cast<T>(numbers[next++]);
  }
  template <class Body>
  void group(const char*, const Body& body) {
    body();
  }
  template <class Items, class Body>
  void list(const char*, Items&& items, const Body& body) {
    for (auto& item : items) body(item);
  }
  template <class Items>
  void row(const char*, Items&& items) {
    for (auto& item : items) value("", item);
  }
};

template <class Real, template <class> class Kicks>
firmware::FlashedAxis<Real, Kicks<Real>> in_scalar(const firmware::FlashedAxis<float, Kicks<float>>& axis) {
  NumbersOut out;
  visit_law_numbers(axis, out);
  firmware::FlashedAxis<Real, Kicks<Real>> same;
  same.kicks.table.count = axis.kicks.table.count;
  NumbersIn in{out.numbers};
  visit_law_numbers(same, in);
  return same;
}

template <class Law, class Real>
void expect_the_same_law(const std::string& name) {
  SCOPED_TRACE(name);
  const config::Node node = scene(name);
  Law c{};
  ASSERT_EQ(init(c, image_of(name)), BREAKAWAY_OK);
  const auto run = [&](const auto& axis) {
    law::AxisController<Real, std::remove_cvref_t<decltype(axis.kicks)>> cpp{axis.law, axis.k3_table, axis.kicks};
    expect_equal_bits(cpp, c, 7);
  };
  if (config::is_by_work(node))
    run(in_scalar<Real, law::WorkKicks>(config::flashed_by_work<float>(node).axes[0]));
  else
    run(in_scalar<Real, law::BrakedKicks>(config::flashed<float>(node).axes[0]));
}

TEST(LawInC, GivesTheBitsOfTheClassInFloat) {
  for (const char* name : {"can_axis", "braked_axis", "belt_axis", "presliding_axis", "move_axis"})
    expect_the_same_law<breakaway_law_f, float>(name);
}

TEST(LawInC, HasEveryAxisOfANode) {
  const Image image = image_of("three_axes");
  breakaway_law_f law{};
  double periods = 0;
  for (unsigned axis = 0; axis < 3; ++axis) {
    ASSERT_EQ(init(law, image, axis), BREAKAWAY_OK);
    periods += status(law).period_s;
  }
  EXPECT_NEAR(periods, 3e-3, 1e-6);
  EXPECT_EQ(init(law, image, 3), BREAKAWAY_NO_SUCH_AXIS);
  EXPECT_EQ(status(law).mode, BREAKAWAY_APPROACH) << "a law that is there stays as it was";
}

// The numbers of the image are those of float, so that the class is given them as well.
TEST(LawInC, InDoubleHoldsAnAxisAsTheFloatDoes) {
  for (const char* name : {"can_axis", "braked_axis", "belt_axis"}) expect_the_same_law<breakaway_law_d, double>(name);
}

TEST(LawInC, RefusesEveryImageWithAChangedByteAndEveryShortOne) {
  const Image image = image_of("braked_axis");
  breakaway_law_f law{};
  for (std::size_t at = 0; at < image.size(); ++at) {
    Image changed = image;
    changed[at] ^= 0x40;
    ASSERT_NE(init(law, changed), BREAKAWAY_OK) << at;
    ASSERT_NE(init(law, Image(image.begin(), image.begin() + static_cast<std::ptrdiff_t>(at))), BREAKAWAY_OK) << at;
  }
  EXPECT_EQ(update(law, 1, true), 0) << "nothing was initialised by any of them";
}

// Whatever the bytes say under a right checksum, what is read stays inside them.
TEST(LawInC, StaysInsideAnImageThatLiesUnderARightChecksum) {
  const Image image = image_of("braked_axis");
  std::mt19937_64 bits{3};
  long taken = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    Image changed(image.begin(), image.end() - 4);
    for (auto n = bits() % 3 + 1; n-- > 0;) changed[bits() % changed.size()] = static_cast<std::uint8_t>(bits());
    if (bits() % 4 == 0) changed.resize(bits() % changed.size());
    const std::uint32_t checksum = firmware::checksum_of_bytes(changed);
    for (int byte = 0; byte < 4; ++byte) changed.push_back(static_cast<std::uint8_t>(checksum >> (8 * byte)));
    breakaway_law_f law{};
    if (init(law, changed) != BREAKAWAY_OK) continue;
    ++taken;
    for (int period = 0; period < 50; ++period)
      ASSERT_LE(std::fabs(update(law, -0.001F, true)), static_cast<float>(status(law).max_force_N));
  }
  EXPECT_GT(taken, 50);
}

TEST(LawInC, SaysWhatIsWrong) {
  const Image image = image_of("braked_axis");
  breakaway_law_f law{};
  const auto text = [](int result) { return std::string{breakaway_result_text(result)}; };
  EXPECT_EQ(breakaway_law_f_init(&law, sizeof law, BREAKAWAY_LAW_ABI + 1, image.data(), image.size(), 0),
            BREAKAWAY_WRONG_ABI);
  EXPECT_NE(text(BREAKAWAY_WRONG_ABI).find("compile it again"), std::string::npos);
  EXPECT_EQ(breakaway_law_f_init(&law, 100, BREAKAWAY_LAW_ABI, image.data(), image.size(), 0),
            BREAKAWAY_STORAGE_TOO_SMALL);
  EXPECT_EQ(breakaway_law_f_init(nullptr, sizeof law, BREAKAWAY_LAW_ABI, image.data(), image.size(), 0),
            BREAKAWAY_NULL_POINTER);
  EXPECT_EQ(breakaway_law_f_init(&law, sizeof law, BREAKAWAY_LAW_ABI, nullptr, 9, 0), BREAKAWAY_NULL_POINTER);
  EXPECT_EQ(init(law, Image(3)), BREAKAWAY_NO_LAW_IMAGE);
  EXPECT_EQ(init(law, Image(100, 7)), BREAKAWAY_NO_LAW_IMAGE);
  EXPECT_EQ(update(law, 1, true), 0);
  EXPECT_EQ(set_target(law, 1), BREAKAWAY_NOT_INITIALISED);
  EXPECT_EQ(reset(law), BREAKAWAY_NOT_INITIALISED);
  breakaway_law_status s{};
  EXPECT_EQ(breakaway_law_f_status(&law, &s), BREAKAWAY_NOT_INITIALISED);
  for (int result = 0; result <= BREAKAWAY_NOT_INITIALISED; ++result) EXPECT_NE(text(result), "unknown result");
  EXPECT_EQ(text(99), "unknown result");
  EXPECT_STREQ(breakaway_mode_name(BREAKAWAY_HOLD), "hold");
  EXPECT_STREQ(breakaway_fault_name(0), "none");
  EXPECT_STREQ(breakaway_mode_name(-3), "unknown mode");
}

TEST(LawInC, PromisesTheFloorWhereAFineStageAimsNearer) {
  config::Node node = scene("braked_axis");
  node.axes[0].controller.position_tolerance_m = 1e-6;
  const auto reports = config::examine(node);
  breakaway_law_f law{};
  ASSERT_EQ(init(law, config::law_image(config::certified(node, reports))), BREAKAWAY_OK);
  EXPECT_GT(status(law).position_tolerance_m, 1.5e-6);
  EXPECT_EQ(status(law).position_tolerance_m, double{config::flashed<float>(node).axes[0].kicks.fine_floor_m});
}

TEST(LawInC, KeepsItsTargetWhereANewOneIsNoNumber) {
  breakaway_law_f law{};
  ASSERT_EQ(init(law, image_of("braked_axis")), BREAKAWAY_OK);
  ASSERT_EQ(set_target(law, 0.25F), BREAKAWAY_OK);
  EXPECT_EQ(set_target(law, NAN), BREAKAWAY_NOT_A_NUMBER);
  EXPECT_EQ(set_target(law, -INFINITY), BREAKAWAY_NOT_A_NUMBER);
  EXPECT_EQ(status(law).target_m, 0.25);
}

TEST(LawInC, NamesAPositionThatIsNoNumberAndGivesNoForceUntilReset) {
  breakaway_law_d law{};
  ASSERT_EQ(init(law, image_of("braked_axis")), BREAKAWAY_OK);
  EXPECT_EQ(update(law, NAN, true), 0);
  EXPECT_EQ(status(law).mode, BREAKAWAY_FAULT);
  EXPECT_STREQ(breakaway_fault_name(status(law).fault), "measurement is not a number");
  EXPECT_EQ(update(law, -0.01, true), 0);
  ASSERT_EQ(reset(law), BREAKAWAY_OK);
  EXPECT_EQ(status(law).mode, BREAKAWAY_APPROACH);
}

}  // namespace
}  // namespace breakaway
