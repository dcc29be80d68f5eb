// [coupling]: what a node is told of a machine, and what its certificate refuses.
#include <gtest/gtest.h>

#include <string>

#include "../refusal.hpp"
#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/file_contents.hpp"
#include "breakaway/config/flash.hpp"
#include "breakaway/config/machine_design.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/scenario/read_scenario.hpp"

namespace breakaway::config {
namespace {

using testing::refusal;

std::string scene(const char* name) {
  return file_contents(std::string{BREAKAWAY_SOURCE_DIR} + "/sim/scenarios/" + name);
}

std::string gantry() { return scene("coupled_gantry.toml"); }

std::string with(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  if (at == std::string::npos) return "no \"" + from + "\" in it";
  return text.replace(at, from.size(), to);
}

stability::MachineCertificate certificate(const std::string& text) {
  return examine_machine(parse_node(text, "gantry.toml"));
}

TEST(Coupling, BothScenesAreCertified) {
  for (const char* name : {"coupled_gantry.toml", "two_link_arm.toml"}) {
    const stability::MachineCertificate c = certificate(scene(name));
    EXPECT_TRUE(c.certified) << name << ": " << c.reason;
    EXPECT_EQ(refusal([&] { scenario::parse_scenario(scene(name), name); }), "");
  }
}

TEST(Coupling, TheReasonNamesThePairByTheNamesOfTheFile) {
  const auto c = certificate(with(gantry(), "mass_error = 0.02", "mass_error = 0.02\nload_N = [0, 5]"));
  EXPECT_FALSE(c.certified);
  EXPECT_NE(c.reason.find("axis right"), std::string::npos) << c.reason;
  EXPECT_EQ(why_not_certified(parse_node(gantry(), ""), parse_node(gantry(), "").axes[0]), "");
}

TEST(Coupling, IsHeldAgainstTheStartOfItsMachine) {
  const auto said_of = [](const std::string& from, const std::string& to) {
    return refusal([&] { scenario::parse_scenario(with(gantry(), from, to), "gantry.toml"); });
  };
  const std::string start = "q = [-0.03, -0.028]";
  const std::string far = said_of(start, "q = [-0.03, 0.06]"), moving = said_of(start, start + "\nv = [0, 0.1]");
  EXPECT_NE(far.find("0.06 for axis right, 0.06 m from its target, and [coupling] start_m is 0.03"), std::string::npos)
      << far;
  EXPECT_NE(moving.find("[start] v has 0.1 for axis right"), std::string::npos) << moving;
}

TEST(Coupling, ItsDiagonalIsTheMassOfTheAxes) {
  const std::string said = refusal([] { certificate(with(gantry(), "mass_kg = 3.6666666666666667", "mass_kg = 4")); });
  EXPECT_NE(said.find("axis left has [plant] mass_kg = 4"), std::string::npos) << said;
}

TEST(Coupling, IsOfAsManyAxesAsThereAre) {
  const std::string said = refusal([] {
    certificate(with(gantry(), "[1.3333333333333333, 3.6666666666666667]]",
                     "[1.3333333333333333, 3.6666666666666667], [0, 0]]"));
  });
  EXPECT_NE(said.find("the node has 2 axes"), std::string::npos) << said;
}

TEST(Coupling, WhatTheTheoremDoesNotTakeInIsRefusedInASentence) {
  const auto reason = [](const std::string& from, const std::string& to) {
    return certificate(with(gantry(), from, to)).reason;
  };
  EXPECT_NE(reason("fault_stops = \"all\"", "").find("fault_stops"), std::string::npos);
  EXPECT_NE(reason("current_loop_time_constant_s = 1e-4", "current_loop_time_constant_s = 2e-4").find("all are equal"),
            std::string::npos);
  EXPECT_NE(reason("max_force_N = 100", "feedforward_N = 5, max_force_N = 100").find("feedforward_N"),
            std::string::npos);
  EXPECT_NE(reason("speed_m_s = 5", "speed_m_s = 0.01").find("speed_m_s is 0.01"), std::string::npos);
  EXPECT_NE(
      reason("position_tolerance_m = 1e-5", "position_tolerance_m = 1e-5, targets = [{ time_s = 1, position_m = 0.1 }]")
          .find("from 0 m to 0.1 m at once"),
      std::string::npos);
  EXPECT_NE(reason("[loop]", "[bus]\nloss_probability = 0.1\n[loop]").find("loss_probability"), std::string::npos);
  const std::string drive = "encoder_resolution_m = 1e-6";
  const std::string home = drive + "\nhome = \"drive\"\nhome_method = 17\nhome_position_m = ";
  EXPECT_NE(reason(drive, home + "-0.05").find("axis left: home and [controller] target_m go from -0.05 m to 0 m"),
            std::string::npos);
  EXPECT_EQ(reason(drive, home + "-0.03"), "");
  EXPECT_NE(reason(drive, drive + "\ntpdo_delay_max_s = 0.9e-3").find("axis left: [bus] and [drive] delay a reading"),
            std::string::npos);
}

TEST(Coupling, WhatDoesNotFitTheBusIsToldWithTheNameOfTheFileOnce) {
  const std::string said = refusal([] { certificate(with(gantry(), "period_s = 0.001", "period_s = 0.0005")); });
  EXPECT_TRUE(said.starts_with("gantry.toml: 2 axes at [loop] period_s = 0.0005 do not fit")) << said;
  EXPECT_EQ(said.find("gantry.toml", 1), std::string::npos) << said;
}

TEST(Coupling, IsFlashedAsOneMachineUnderOneChecksum) {
  for (const char* name : {"coupled_gantry.toml", "two_link_arm.toml"}) {
    const Node node = parse_node(scene(name), name);
    const stability::MachineCertificate c = examine_machine(node);
    const MachineNode<float> flashed = certified_machine(node, c);
    EXPECT_TRUE(verify(flashed).ok()) << name;
    EXPECT_EQ(flashed.checksum, checksum_of(flashed)) << name;
    EXPECT_EQ(flashed.coordinator.most_kicks, c.most_kicks) << name;
    const std::string header = node_header(flashed, node, c);
    EXPECT_NE(header.find("FlashedMachine<float, 2> node"), std::string::npos) << name;
    EXPECT_NE(header.find("#include \"breakaway/firmware/flashed_machine.hpp\""), std::string::npos) << name;
    EXPECT_NE(header.find("// - each target is given at rest"), std::string::npos) << name;
    EXPECT_NE(header.find("// - a target is a whole count"), std::string::npos) << name;
  }
}

TEST(Coupling, IsNotFlashedWithoutItsCertificateNorAsLawsOfSingleAxes) {
  const Node node = parse_node(with(gantry(), "mass_error = 0.02", "mass_error = 0.3"), "gantry.toml");
  const std::string said = refusal([&] { static_cast<void>(flashed_machine<float>(node, examine_machine(node))); });
  EXPECT_NE(said.find("not certified"), std::string::npos) << said;
  const Node good = parse_node(gantry(), "gantry.toml");
  const std::string single = refusal([&] { static_cast<void>(certified(good, examine(good))); });
  EXPECT_NE(single.find("[coupling]"), std::string::npos) << single;
}

TEST(Coupling, FrictionMustHoldTheMachineWhereAnApproachBegins) {
  const std::string reason = certificate(with(gantry(), "stiffness = [[20, -20], [-20, 20]]\nstart_m = 0.03",
                                              "stiffness = [[140, -140], [-140, 140]]\nstart_m = 0.03"))
                                 .reason;
  EXPECT_NE(reason.find("until all axes run"), std::string::npos) << reason;
}

TEST(Coupling, TheMachineMustBeOneThatTheNodeIsToldOf) {
  const auto said = [](const std::string& from, const std::string& to) {
    return refusal([&] { scenario::parse_scenario(with(gantry(), from, to), "gantry.toml"); });
  };
  EXPECT_NE(said("[[3.7, 1.32]", "[[3.9, 1.32]").find("[machine] mass has 3.9"), std::string::npos);
  EXPECT_NE(said("friction_N = [9, 11]", "friction_N = [9, 13]").find("axis right"), std::string::npos);
  EXPECT_NE(said("machine = { push = 2 }", "machine = { push = 1 }").find("coordinate 2 alone"), std::string::npos);
}

}  // namespace
}  // namespace breakaway::config
