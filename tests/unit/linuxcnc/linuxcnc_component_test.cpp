// The HAL component for LinuxCNC as a thread calls it, period by period.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/flash.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/law.h"
#include "hal.h"
#include "rtapi.h"
#include "rtapi_app.h"

namespace breakaway {
namespace {

// What LinuxCNC keeps of a component that is loaded.
struct Hal {
  std::deque<std::vector<std::max_align_t>> memory;
  std::map<std::string, std::unique_ptr<double>> floats;
  std::map<std::string, std::unique_ptr<bool>> bits;
  std::map<std::string, std::unique_ptr<int>> signed_numbers;
  std::map<std::string, std::unique_ptr<unsigned>> numbers;
  void (*update)(void*, long) = nullptr;
  void* argument = nullptr;
  std::string said;
};
Hal loaded;

std::string formatted(const char* format, std::va_list arguments) {
  char text[400];
  std::vsnprintf(text, sizeof text, format, arguments);
  return text;
}

template <class Value>
void add_pin(std::map<std::string, std::unique_ptr<Value>>& pins, Value** pin, const char* format,
             std::va_list arguments) {
  auto& held = pins[formatted(format, arguments)];
  held = std::make_unique<Value>();
  *pin = held.get();
}

}  // namespace
}  // namespace breakaway

extern "C" {

int hal_init(const char*) { return 1; }
int hal_ready(int) { return 0; }
int hal_exit(int) { return 0; }
void* hal_malloc(long bytes) {
  return breakaway::loaded.memory.emplace_back(static_cast<std::size_t>(bytes) / sizeof(std::max_align_t) + 1).data();
}
int hal_pin_float_newf(hal_pin_dir_t, double** pin, int, const char* format, ...) {
  std::va_list arguments;
  va_start(arguments, format);
  breakaway::add_pin(breakaway::loaded.floats, pin, format, arguments);
  va_end(arguments);
  return 0;
}
int hal_pin_bit_newf(hal_pin_dir_t, bool** pin, int, const char* format, ...) {
  std::va_list arguments;
  va_start(arguments, format);
  breakaway::add_pin(breakaway::loaded.bits, pin, format, arguments);
  va_end(arguments);
  return 0;
}
int hal_pin_s32_newf(hal_pin_dir_t, int** pin, int, const char* format, ...) {
  std::va_list arguments;
  va_start(arguments, format);
  breakaway::add_pin(breakaway::loaded.signed_numbers, pin, format, arguments);
  va_end(arguments);
  return 0;
}
int hal_pin_u32_newf(hal_pin_dir_t, unsigned** pin, int, const char* format, ...) {
  std::va_list arguments;
  va_start(arguments, format);
  breakaway::add_pin(breakaway::loaded.numbers, pin, format, arguments);
  va_end(arguments);
  return 0;
}
int hal_export_funct(const char*, void (*function)(void*, long), void* argument, int, int, int) {
  breakaway::loaded.update = function;
  breakaway::loaded.argument = argument;
  return 0;
}
void rtapi_print_msg(int, const char* format, ...) {
  std::va_list arguments;
  va_start(arguments, format);
  breakaway::loaded.said += breakaway::formatted(format, arguments);
  va_end(arguments);
}
int rtapi_snprintf(char* to, unsigned long bytes, const char* format, ...) {
  std::va_list arguments;
  va_start(arguments, format);
  const int written = std::vsnprintf(to, bytes, format, arguments);
  va_end(arguments);
  return written;
}

}  // extern "C"

namespace breakaway {
namespace {

class LinuxCncComponent : public ::testing::Test {
 protected:
  void SetUp() override {
    const config::Node node = config::read_node(BREAKAWAY_SOURCE_DIR "/sim/scenarios/braked_axis.toml");
    const auto image = config::law_image(config::certified(node, config::examine(node)));
    std::ofstream{file_, std::ios::binary}.write(reinterpret_cast<const char*>(image.data()),
                                                 static_cast<std::streamsize>(image.size()));
    loaded = {};
    *parameter_image = file_.data();
    *parameter_count = 1;
    ASSERT_EQ(rtapi_app_main(), 0) << loaded.said;
  }
  void TearDown() override { std::filesystem::remove(file_); }

  double& number(const char* name) { return *loaded.floats.at(pin(name)); }
  bool& bit(const char* name) { return *loaded.bits.at(pin(name)); }
  int fault_code() { return *loaded.signed_numbers.at(pin("fault-code")); }
  void run(int periods, long period_ns = 1'000'000) {
    while (periods-- > 0) loaded.update(loaded.argument, period_ns);
  }
  void reset() {
    for (const bool level : {true, false}) {
      bit("reset") = level;
      run(1);
    }
  }

 private:
  static std::string pin(const char* name) { return std::string{"breakaway.0."} + name; }

  std::string file_ = ::testing::TempDir() + "linuxcnc_component_test.law";
};

TEST_F(LinuxCncComponent, GivesNoForceUntilPositionAndCommandAreConnected) {
  bit("enable") = true;
  run(3);
  EXPECT_EQ(fault_code(), 101);
  EXPECT_EQ(loaded.said.find("position is connected to nothing"),
            loaded.said.rfind("position is connected to nothing"));
  number("position") = 0;
  reset();
  EXPECT_EQ(fault_code(), 102);
  EXPECT_EQ(number("force"), 0);
  number("command") = 0.05;
  reset();
  EXPECT_FALSE(bit("fault"));
  EXPECT_GT(number("force"), 0);
}

TEST_F(LinuxCncComponent, EndsAFaultByResetOnly) {
  number("position") = 0;
  number("command") = 0.05;
  bit("enable") = true;
  run(30'000);  // and the axis never moves
  const int jammed = fault_code();
  EXPECT_NE(loaded.said.find("axis does not move under kicks"), std::string::npos) << loaded.said;
  bit("enable") = false;
  run(5);
  bit("enable") = true;
  run(5);
  EXPECT_EQ(fault_code(), jammed);
  EXPECT_TRUE(bit("fault"));
  EXPECT_EQ(number("force"), 0);
  reset();
  EXPECT_FALSE(bit("fault"));
  EXPECT_GT(number("force"), 0);
}

TEST_F(LinuxCncComponent, StopsInAThreadOfAnotherPeriod) {
  number("position") = 0;
  number("command") = 0.05;
  bit("enable") = true;
  run(10);
  EXPECT_GT(number("force"), 0);
  run(1, 2'000'000);
  EXPECT_EQ(fault_code(), 103);
  EXPECT_EQ(number("force"), 0);
}

}  // namespace
}  // namespace breakaway
