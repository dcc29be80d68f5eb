// A device on the virtual bus whose objects are read and written one by one by SDO, and held against its EDS.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "breakaway/canopen/sdo_client.hpp"
#include "breakaway/virtual_bus/virtual_bus.hpp"
#include "eds_file.hpp"

namespace breakaway::eds {

using canopen::SdoAbort;
using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

struct Answer {
  SdoAbort abort = SdoAbort::none;
  Bytes bytes{};
};

class WalkedDevice {
 public:
  explicit WalkedDevice(std::uint8_t node_id) : id{node_id}, client_{node_id, 500ms} {}
  virtual ~WalkedDevice() = default;

  Answer read(std::uint16_t index, std::uint8_t sub) {
    EXPECT_EQ(client_.start_read(index, sub), canopen::SdoStart::started);
    const Answer ended = finish();
    return {ended.abort, {client_.data().begin(), client_.data().end()}};
  }
  SdoAbort write(std::uint16_t index, std::uint8_t sub, const Bytes& bytes) {
    EXPECT_EQ(client_.start_write(index, sub, bytes), canopen::SdoStart::started);
    return finish().abort;
  }
  SdoAbort write(const Entry& entry, std::int64_t value) {
    Bytes bytes(entry.size());
    for (std::size_t i = 0; i < bytes.size(); ++i)
      bytes[i] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i));
    return write(entry.index, entry.sub, bytes);
  }
  void run_for(hal::Duration duration) {
    for (const hal::Time end = now + duration; now < end;) step();
  }

  const std::uint8_t id;

 protected:
  // Brings bus and device to `now`.
  virtual void advance() = 0;

  virtual_bus::VirtualBus bus{virtual_bus::VirtualBusConfig{}};
  virtual_bus::VirtualBus::Port& tool = bus.add_port();
  virtual_bus::VirtualBus::Port& device = bus.add_port();
  hal::Time now{};

 private:
  void step() {
    now += 1ms;
    advance();
    for (hal::ReceivedFrame received; tool.receive(received);) client_.on_frame(received.frame);
    hal::CanFrame frame;
    if (client_.next_frame(frame, now)) {
      EXPECT_EQ(tool.send(frame, now + 1s), hal::SendResult::queued);
    }
  }
  Answer finish() {
    while (client_.busy() && client_.poll(now) == canopen::SdoResult::busy) step();
    const auto result = client_.poll(now);
    EXPECT_TRUE(result == canopen::SdoResult::done || result == canopen::SdoResult::aborted) << int(result);
    return {result == canopen::SdoResult::aborted ? client_.abort_code() : SdoAbort::none, {}};
  }

  canopen::SdoClient client_;
};

inline std::int64_t number_of(const Entry& entry, const Bytes& bytes) {
  std::uint64_t number = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) number = number << 8 | bytes[i];
  const bool is_negative = entry.type() <= 4 && bytes.back() >= 0x80;
  return static_cast<std::int64_t>(is_negative ? number | ~std::uint64_t{0} << (8 * bytes.size()) : number);
}

inline void expect_answers_as_written(WalkedDevice& device, const Entry& entry) {
  const Answer answer = device.read(entry.index, entry.sub);
  ASSERT_EQ(answer.abort, SdoAbort::none);
  // Only what the device itself goes on writing has no value in the file.
  if (!entry.text("DefaultValue")) {
    EXPECT_EQ(entry.access(), "ro");
  }
  if (entry.is_text()) {
    const std::string answered(answer.bytes.begin(), answer.bytes.end());
    EXPECT_EQ(entry.text("DefaultValue").value_or(answered), answered);
    return;
  }
  ASSERT_EQ(answer.bytes.size(), entry.size());
  if (const auto expected = entry.number("DefaultValue", device.id)) {
    EXPECT_EQ(number_of(entry, answer.bytes), *expected);
  }
}

inline void expect_access_as_written(WalkedDevice& device, const Entry& entry) {
  const bool writable = entry.access() != "ro";
  const Answer answer = device.read(entry.index, entry.sub);
  const Bytes bytes = entry.is_text() ? Bytes{'x'} : answer.bytes;
  EXPECT_EQ(device.write(entry.index, entry.sub, bytes) != SdoAbort::read_only, writable);
}

inline void expect_limits_as_written(WalkedDevice& device, const Entry& entry) {
  if (entry.access() == "ro" || entry.is_text()) return;
  const auto low = entry.number("LowLimit", device.id), high = entry.number("HighLimit", device.id);
  if (low) {
    EXPECT_EQ(device.write(entry, *low - 1), SdoAbort::value_too_low);
  }
  if (high) {
    EXPECT_EQ(device.write(entry, *high + 1), SdoAbort::value_too_high);
  }
  const auto bits = 8 * entry.size();
  const bool is_signed = entry.type() <= 4;
  const std::int64_t least = is_signed ? -(std::int64_t{1} << (bits - 1)) : 0;
  const std::int64_t most = (std::int64_t{1} << (is_signed ? bits - 1 : bits)) - 1;
  for (const std::int64_t inside : {low.value_or(least), high.value_or(most)}) {
    const SdoAbort abort = device.write(entry, inside);
    EXPECT_TRUE(abort != SdoAbort::value_too_low && abort != SdoAbort::value_too_high) << inside;
  }
}

// What is not in the file does not answer.
inline void expect_nothing_else(WalkedDevice& device, const EdsFile& file) {
  std::set<std::pair<unsigned, unsigned>> known;
  std::set<unsigned> indices;
  for (const Entry& entry : file.entries()) {
    known.emplace(entry.index, entry.sub);
    indices.insert(entry.index);
  }
  const std::pair<unsigned, unsigned> ranges[] = {{0x1000, 0x2200}, {0x6000, 0x6600}};
  for (const auto& [first, last] : ranges)
    for (unsigned index = first; index < last; ++index)
      for (unsigned sub = 0; sub < (indices.contains(index) ? 256U : 1U); ++sub) {
        if (known.contains({index, sub})) continue;
        const SdoAbort expected = indices.contains(index) ? SdoAbort::no_such_subindex : SdoAbort::no_such_object;
        const Answer answer = device.read(static_cast<std::uint16_t>(index), static_cast<std::uint8_t>(sub));
        ASSERT_EQ(answer.abort, expected) << std::hex << index << ':' << sub;
      }
}

inline void expect_device_as_written(WalkedDevice& device, const EdsFile& file) {
  ASSERT_GT(file.entries().size(), 20U);
  for (const auto check : {expect_answers_as_written, expect_access_as_written, expect_limits_as_written})
    for (const Entry& entry : file.entries()) {
      const testing::ScopedTrace trace{__FILE__, __LINE__, entry.name() + " " + entry.keys.at("ParameterName")};
      check(device, entry);
    }
}

// CiA 306: every object is in the one list that its index belongs to, and arrays and records say how many they hold.
inline void expect_lists_complete(const EdsFile& file) {
  std::set<unsigned> listed;
  for (const auto* const list : {"MandatoryObjects", "OptionalObjects", "ManufacturerObjects"}) {
    const Section& section = file.sections.at(list);
    EXPECT_EQ(std::stoul(section.at("SupportedObjects")), section.size() - 1) << list;
    for (std::size_t i = 1; i < section.size(); ++i)
      EXPECT_TRUE(listed.insert(static_cast<unsigned>(std::stoul(section.at(std::to_string(i)), nullptr, 0))).second);
  }
  std::map<unsigned, unsigned> present;
  for (const Entry& entry : file.entries()) ++present[entry.index];
  EXPECT_EQ(listed.size(), present.size());
  for (const auto& [index, count] : present) {
    EXPECT_TRUE(listed.contains(index)) << index;
    char name[5];
    std::snprintf(name, sizeof name, "%04X", index);
    const Section& section = file.sections.at(name);
    if (section.contains("SubNumber")) {
      EXPECT_EQ(std::stoul(section.at("SubNumber")), count) << name;
    } else {
      EXPECT_EQ(count, 1U) << name;
    }
  }
}

}  // namespace breakaway::eds
