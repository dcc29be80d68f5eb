// The configuration as it is flashed: intact and certified, or refused by name.
#include "breakaway/design/flashed_header.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <limits>
#include <string>

#include "../refusal.hpp"

namespace {

using namespace breakaway;
using law::FlashedAxisError;

constexpr design::AxisDesign axis_design{.mass_kg = 1,
                                         .stiffness_N_per_m = 400,
                                         .approach_damping_Ns_per_m = 32,
                                         .kick_damping_Ns_per_m = 60,
                                         .friction = {2.5, 5},
                                         .max_force_N = 50,
                                         .period_s = 1e-3,
                                         .encoder_resolution_m = 1e-6,
                                         .latency_ticks = 1,
                                         .position_tolerance_m = 1e-5};

constexpr law::AxisParameters<float> parameters{.mass_kg = 1,
                                                .stiffness_N_per_m = 400,
                                                .approach_damping_Ns_per_m = 32,
                                                .kick_damping_Ns_per_m = 60,
                                                .friction = {2.5F, 5},
                                                .max_force_N = std::numeric_limits<float>::infinity(),
                                                .position_tolerance_m = 1e-5F,
                                                .encoder_resolution_m = 1e-6F,
                                                .period_s = 1e-3F};

law::FlashedAxis<float> flashed() {
  const auto report = design::design_axis(axis_design);
  EXPECT_TRUE(report.certified);
  return design::flashed_axis(parameters, axis_design, report);
}

// The same configuration with a checksum that fits it: what a wrong generator would write.
FlashedAxisError verdict_of(law::FlashedAxis<float> axis) {
  axis.checksum = law::checksum_of(axis);
  return law::verify(axis);
}

TEST(FlashedAxis, OfACertifiedDesignIsAccepted) { EXPECT_EQ(law::verify(flashed()), FlashedAxisError::none); }

TEST(FlashedAxis, NeverAsksForMoreForceThanTheDriveWasCertifiedFor) {
  EXPECT_EQ(flashed().parameters.max_force_N, 50.0F);
}

// IEEE 802.3: the check value of CRC-32 is that of the nine digits "123456789"; of words, that of "12345678".
TEST(FlashedAxis, ChecksumIsTheCrc32OfIeee802) {
  law::Crc32 crc;
  crc.add(0x34333231U);
  crc.add(0x38373635U);
  EXPECT_EQ(crc.value(), 0x9AE0DAAFU);  // by zlib.crc32(b"12345678")
}

TEST(FlashedAxis, EveryDamagedBitIsNoticed) {
  const law::FlashedAxis<float> intact = flashed();
  for (std::size_t offset = 0; offset < offsetof(law::FlashedAxis<float>, limits); ++offset) {
    law::FlashedAxis<float> damaged = intact;
    if (offset >= offsetof(law::AxisParameters<float>, latency_periods) && offset < sizeof damaged.parameters) continue;
    unsigned char byte = 0;
    std::memcpy(&byte, reinterpret_cast<const unsigned char*>(&intact) + offset, 1);
    byte ^= static_cast<unsigned char>(1U << offset % 8);
    std::memcpy(reinterpret_cast<unsigned char*>(&damaged) + offset, &byte, 1);
    EXPECT_EQ(law::verify(damaged), FlashedAxisError::checksum_differs) << offset;
  }
}

TEST(FlashedAxis, WhatIsNotCoveredByItsCertificateIsRefusedByName) {
  auto axis = flashed();
  axis.parameters.mass_kg = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(verdict_of(axis), FlashedAxisError::parameters_invalid);
  axis = flashed();
  axis.limits.certified = false;
  EXPECT_EQ(verdict_of(axis), FlashedAxisError::not_certified);
  axis = flashed();
  axis.parameters.friction.upper_N = 6;
  EXPECT_EQ(verdict_of(axis), FlashedAxisError::friction_outside_certificate);
  axis = flashed();
  axis.parameters.max_force_N = 60;
  EXPECT_EQ(verdict_of(axis), FlashedAxisError::force_outside_certificate);
  axis = flashed();
  axis.parameters.period_s = 2e-3F;
  EXPECT_EQ(verdict_of(axis), FlashedAxisError::period_outside_certificate);
  axis = flashed();
  axis.parameters.position_tolerance_m = 1e-4F;
  EXPECT_EQ(verdict_of(axis), FlashedAxisError::tolerance_outside_certificate);
  axis.limits.position_tolerance_m = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(verdict_of(axis), FlashedAxisError::tolerance_outside_certificate);
}

TEST(FlashedHeader, IsRefusedForADesignThatIsNotCertified) {
  auto coarse = axis_design;
  coarse.position_tolerance_m = 1e-9;
  const auto report = design::design_axis(coarse);
  const std::string message = breakaway::testing::refusal([&] { design::flashed_axis(parameters, coarse, report); });
  EXPECT_NE(message.find("not certified"), std::string::npos) << message;
  EXPECT_NE(message.find("tolerance"), std::string::npos) << message;
}

TEST(FlashedHeader, NamesItsSourceInOneLineWhateverTheName) {
  const auto report = design::design_axis(axis_design);
  const std::string text = design::flashed_header(flashed(), report, "a\nint x;\\");
  EXPECT_NE(text.find("from a?int x;?; do not edit"), std::string::npos);
}

}  // namespace
